"""Advice: a warning at initialisation that names the values, after which the FMU runs like any other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import demo_advice
import pytest
from fmu_driver import Instance

from fmukit.interface import Advice, output, parameter, sampled
from fmukit.packaging.builder import build

WARNING = "threshold = 1.25 is 100 %% below 1.5; raise it"
Advise = Callable[[], Instance]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(demo_advice.COMPONENT, tmp_path_factory.mktemp("advice"))


@pytest.fixture
def instance(built: Path) -> Iterator[Instance]:
    made = Instance(built, built.parent / "unpacked")
    yield made
    made.free()


def test_advice_is_given_once_and_the_run_goes_on(instance: Instance) -> None:
    instance.initialise({"threshold": 1.25})
    assert instance.messages == [WARNING]
    assert instance["fault"] == 0
    assert all(instance.step(1e-2) for _ in range(3))
    assert (instance["low"], instance.messages) == (1.0, [WARNING])


def test_advice_that_begins_to_apply_during_the_run_is_given_then(instance: Instance) -> None:
    instance.initialise({"threshold": 2.0})
    assert instance.step(1e-2)
    instance.set({"bar": 3.0})
    assert instance.messages == []
    assert all(instance.step(1e-2) for _ in range(3))
    assert instance.messages == [WARNING.replace("1.25", "2")]
    instance.set({"bar": 0.0})
    assert instance.step(1e-2)
    instance.set({"bar": 3.0})
    assert instance.step(1e-2)
    assert instance.messages == 2 * [WARNING.replace("1.25", "2")]


def test_no_advice_where_it_does_not_apply(instance: Instance) -> None:
    instance.initialise()
    assert instance.step(1e-2)
    assert instance.messages == []


def test_outputs_read_during_initialisation_do_not_repeat_it(instance: Instance) -> None:
    instance.fmu.setupExperiment(startTime=0.0)
    instance.set({"threshold": 1.25})
    instance.fmu.enterInitializationMode()
    assert instance["low"] == 1.0
    instance.fmu.exitInitializationMode()
    assert instance.messages == [WARNING]


def test_every_life_is_advised(instance: Instance) -> None:
    instance.initialise({"threshold": 1.25})
    instance.fmu.reset()
    instance.initialise({"threshold": 1.25})
    assert instance.messages == [WARNING, WARNING]


@pytest.mark.parametrize(("name", "text"), [("nothing", "words"), ("fault", "words"), ("y", "x = {x}, z = {z}")])
def test_advice_on_what_does_not_exist_is_refused(name: str, text: str) -> None:
    variables = [parameter("x", "m", "a parameter", 1.0), output("y", "m", "an output")]
    with pytest.raises(ValueError, match=f"gives advice on {'z' if '{z}' in text else name},"):
        sampled("Demo", "a demo", step=1.0, variables=variables, advice=[Advice(name, text)])
