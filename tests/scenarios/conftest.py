"""Scenario runs shared by the tests: each is made once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path

import pytest

from cosim.engine.loader import Loader
from cosim.engine.models import find
from cosim.model.configuration import Configuration
from cosim.model.system import parse_assignments
from cosim.run import prepare
from cosim.run.request import Request
from cosim.run.running import Finished, run
from cosim.scenario.discovery import load

Run = Callable[..., Finished]
Configured = Callable[..., Configuration]


@pytest.fixture(scope="session")
def scenario_run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Run]:
    """scenario_run(name, "instance.variable=value", ..., seed=0): a run that ended well."""

    @cache
    def made(name: str, *assignments: str, seed: int = 0) -> Finished:
        folder = Path(tmp_path_factory.mktemp(name))
        finished = run(Request(load(name), folder, parse_assignments(assignments), seed))
        assert finished.summary.status == "ok", finished.summary.reason
        return finished

    yield made
    made.cache_clear()


@pytest.fixture(scope="session")
def configured(tmp_path_factory: pytest.TempPathFactory) -> Configured:
    """configured(name, "instance.variable=value", ...): the values a scenario's system would start with."""

    def made(name: str, *assignments: str) -> Configuration:
        request = Request(load(name), tmp_path_factory.getbasetemp(), parse_assignments(assignments))
        with Loader(find) as loader:
            return prepare.configured(request, loader).configuration

    return made
