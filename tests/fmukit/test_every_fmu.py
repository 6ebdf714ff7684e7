"""What must hold for every FMU of the catalogue: valid, equal to its kernel to the bit, independent, repeatable."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Iterator
from pathlib import Path

import fmpy.validation
import pytest
from fmu_driver import Instance

from fmukit.build.cache import cached
from fmukit.component import Component
from fmukit.direct import Direct
from fmukit.interface import Interface
from fmus import CATALOGUE

Make = Callable[[Component], Instance]
Script = list[dict[str, float]]

every_component = pytest.mark.parametrize("component", CATALOGUE, ids=lambda component: component.interface.name)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("unzipped")


@pytest.fixture
def fresh(folder: Path) -> Iterator[Make]:
    made: list[Instance] = []

    def instantiate(component: Component) -> Instance:
        made.append(Instance(cached(component), folder / component.interface.name))
        return made[-1]

    yield instantiate
    for instance in made:
        instance.free()


def _script(interface: Interface, count: int = 30) -> Script:
    """Input values near the start values, inside the limits, changing at every step."""
    generator = random.Random(interface.name)
    inputs = [(v, v.nominal or 0.1 * abs(float(v.start)) or 0.1) for v in interface.select("input")]

    def value(variable, scale: float) -> float:  # type: ignore[no-untyped-def]
        low = -1e300 if variable.minimum is None else variable.minimum
        high = 1e300 if variable.maximum is None else variable.maximum
        return min(max(float(variable.start) + 0.1 * scale * generator.uniform(-1, 1), low), high)

    return [{variable.name: value(variable, scale) for variable, scale in inputs} for _ in range(count)]


def _play(instance: Instance, interface: Interface, script: Script) -> list[dict[str, float]]:
    seen = []
    for values in script:
        instance.set(values)
        assert instance.step(interface.step), instance.messages
        seen.append(instance.outputs())
    return seen


@every_component
def test_validators_are_satisfied(component: Component) -> None:
    file = str(cached(component))
    assert fmpy.validation.validate_fmu(file) == []
    tool = Path(sysconfig.get_path("scripts")) / "fmutool"
    done = subprocess.run([str(tool), "-input", file, "-check"], capture_output=True, text=True, check=True)
    assert "compliant with FMI-2.0" in done.stdout + done.stderr
    assert "No semantic error" in done.stdout + done.stderr


@every_component
def test_trajectory_is_that_of_the_kernel_to_the_bit(component: Component, fresh: Make) -> None:
    interface = component.interface
    script = _script(interface)
    reference = Direct(component)
    instance = fresh(component).initialise()
    expected = [reference.outputs()]
    for values in script:
        reference.set(values)
        if interface.kind == "sampled":
            reference.sample()
        else:
            reference.advance(interface.step)
        expected.append(reference.outputs())
    found = [instance.outputs(), *_play(instance, interface, script)]
    for outputs in found:
        assert outputs.pop("fault") == 0
    assert found == expected


@every_component
def test_instances_are_independent_and_reset_repeats(component: Component, fresh: Make) -> None:
    interface = component.interface
    script = _script(interface)
    alone = _play(fresh(component).initialise(), interface, script)
    one, other = fresh(component).initialise(), fresh(component).initialise()
    for values, expected in zip(script, alone, strict=True):
        one.set(values)
        assert one.step(interface.step)
        assert other.step(interface.step)
        assert one.outputs() == expected
    one.fmu.reset()
    assert _play(one.initialise(), interface, script) == alone


@every_component
def test_state_replays_in_place_and_from_bytes(component: Component, fresh: Make) -> None:
    interface = component.interface
    script = _script(interface)
    instance, other = fresh(component).initialise(), fresh(component)
    _play(instance, interface, script[:7])
    state, time = instance.fmu.getFMUstate(), instance.time
    data = instance.fmu.serializeFMUstate(state)
    expected = _play(instance, interface, script[7:])
    instance.fmu.setFMUstate(state)
    instance.time = time
    assert _play(instance, interface, script[7:]) == expected
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(data))
    other.time = time
    assert _play(other, interface, script[7:]) == expected


@every_component
def test_nan_on_any_input_changes_nothing_but_discards_a_step(component: Component, fresh: Make) -> None:
    instance = fresh(component).initialise()
    for name in component.interface.names("input"):
        before = instance.outputs()
        instance.messages.clear()
        instance.set({name: float("nan")})
        assert len(instance.messages) == 1
        assert name in instance.messages[0]
        assert not instance.step(1e-3)
        assert instance.outputs() == {**before, "fault": 1}


@pytest.mark.parametrize("size", [1e-3, 2.5e-3, 1e-13])
@pytest.mark.parametrize("component", [c for c in CATALOGUE if c.interface.kind == "sampled"], ids=lambda c: c.model)
def test_host_steps_do_not_change_the_samples(component: Component, fresh: Make, size: float) -> None:
    interface = component.interface
    script = _script(interface, 8)
    expected = _play(fresh(component).initialise(), interface, script)
    instance = fresh(component).initialise()
    for k, values in enumerate(script):
        instance.set(values)
        if size < 1e-12:
            assert instance.step(size)
        end = (k + 1) * interface.step
        while instance.time < end - 1e-12:
            assert instance.step(min(max(size, 1e-3), end - instance.time))
        assert instance.outputs() == expected[k]


_RUN_ALL = """
import json, sys
from pathlib import Path
from fmu_driver import Instance

values = {}
instances = [Instance(Path(file), Path(sys.argv[1]) / f"{k}").initialise() for k, file in enumerate(sys.argv[2:])]
for instance in instances:
    assert all(instance.step(1e-2) for _ in range(5)), instance.messages
    values[instance.description.modelName] = instance.outputs()
    instance.free()
print(json.dumps(values, sort_keys=True))
"""


@pytest.mark.skipif(not CATALOGUE, reason="the catalogue is empty")
def test_all_in_one_process_in_several_orders(tmp_path: Path) -> None:
    files = [str(cached(component)) for component in CATALOGUE]
    generator = random.Random(1)
    seen = set()
    for order in (files, files[::-1], generator.sample(files, len(files))):
        done = subprocess.run(
            [sys.executable, "-c", _RUN_ALL, str(tmp_path), *order],
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
            check=True,
        )
        seen.add(json.dumps(json.loads(done.stdout)))
        assert len(json.loads(done.stdout)) == len(CATALOGUE)
        for made in tmp_path.iterdir():
            subprocess.run(["rm", "-r", str(made)], check=True)
    assert len(seen) == 1
