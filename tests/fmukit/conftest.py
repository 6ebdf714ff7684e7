"""FMUs, the demos and those of the catalogue, and instances of them that are freed after the test."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import demo_filter
import demo_spring
import pytest
from fmu_driver import Instance

from fmukit.component import Component
from fmukit.packaging.builder import build
from fmukit.packaging.cached import cached


@pytest.fixture(scope="session")
def demo_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fmus")
    for component in (demo_spring.COMPONENT, demo_filter.COMPONENT):
        build(component, folder)
    return folder


@pytest.fixture
def make(demo_folder: Path) -> Iterator[Callable[..., Instance]]:
    """make("DemoSpring") instantiates; instances of one FMU share its unzipped folder."""
    made: list[Instance] = []

    def instantiate(model: str) -> Instance:
        made.append(Instance(demo_folder / f"{model}.fmu", demo_folder / model, f"{model}{len(made)}"))
        return made[-1]

    yield instantiate
    for instance in made:
        instance.free()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("unzipped")


@pytest.fixture
def fresh(folder: Path) -> Iterator[Callable[[Component], Instance]]:
    """fresh(component) instantiates; instances of one FMU share its unzipped folder."""
    made: list[Instance] = []

    def instantiate(component: Component) -> Instance:
        made.append(Instance(cached(component), folder / component.interface.name))
        return made[-1]

    yield instantiate
    for instance in made:
        instance.free()
