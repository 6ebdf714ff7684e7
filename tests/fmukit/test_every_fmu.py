"""What must hold for every FMU of the catalogue: valid, equal to its kernel to the bit, independent, repeatable."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import sysconfig
from collections.abc import Callable, Iterator
from itertools import repeat
from pathlib import Path

import fmpy.validation
import pytest
from fmu_driver import Instance
from regimes import Values, regime

from fmukit.component import Component
from fmukit.direct import Direct
from fmukit.interface import Interface
from fmukit.packaging.cached import cached
from fmus import CATALOGUE

Make = Callable[[Component], Instance]

_ACCURACY = 1e-4  # of the plant's forces in the instant after a jump of the inputs, at substeps of 1 ms

every_component = pytest.mark.parametrize("component", CATALOGUE, ids=lambda component: component.interface.name)


@every_component
def test_validators_are_satisfied(component: Component) -> None:
    file = str(cached(component))
    assert fmpy.validation.validate_fmu(file) == []
    tool = Path(sysconfig.get_path("scripts")) / "fmutool"
    done = subprocess.run([str(tool), "-input", file, "-check"], capture_output=True, text=True, check=True)
    assert "compliant with FMI-2.0" in done.stdout + done.stderr
    assert "No semantic error" in done.stdout + done.stderr


@every_component
def test_drive_reaches_the_regime_in_which_the_model_works(component: Component, fresh: Make) -> None:
    step, drive = component.interface.step, regime(component.interface)
    instance = fresh(component).initialise(drive.parameters)
    last = instance.play(drive.script(step), step)[-1]
    assert not instance.messages
    for name, least in drive.reached.items():
        assert abs(last[name]) > least, name


@every_component
def test_trajectory_is_that_of_the_kernel_to_the_bit(component: Component, fresh: Make) -> None:
    interface, drive = component.interface, regime(component.interface)
    script = drive.script(interface.step)
    reference = Direct(component, drive.parameters)
    instance = fresh(component).initialise(drive.parameters)
    expected = [reference.outputs()]
    for values in script:
        reference.set(values)
        if interface.kind == "sampled":
            reference.sample()
        else:
            reference.advance(interface.step)
        expected.append(reference.outputs())
    found = [instance.outputs(), *instance.play(script, interface.step)]
    for outputs in found:
        assert outputs.pop("fault") == 0
    assert found == expected


@every_component
def test_instances_are_independent_and_reset_repeats(component: Component, fresh: Make) -> None:
    interface, drive = component.interface, regime(component.interface)
    script = drive.script(interface.step)
    alone = fresh(component).initialise(drive.parameters).play(script, interface.step)
    one, other = fresh(component).initialise(drive.parameters), fresh(component).initialise()
    for values, expected in zip(script, alone, strict=True):
        one.set(values)
        assert one.step(interface.step)
        assert other.step(interface.step)
        assert one.outputs() == expected
    one.fmu.reset()
    assert one.initialise(drive.parameters).play(script, interface.step) == alone


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


def _jitter() -> Iterator[float]:
    generator = random.Random(5)
    while True:
        yield generator.uniform(5e-5, 3e-3)


_SCHEDULES: dict[str, Callable[[Interface], Iterator[float]]] = {
    "1 ms": lambda interface: repeat(1e-3),
    "5 ms": lambda interface: repeat(5e-3),
    "own period": lambda interface: repeat(interface.step),
    "0.3 ms": lambda interface: repeat(3e-4),
    "jitter": lambda interface: _jitter(),
}


def _common(instance: Instance, interface: Interface, sizes: Iterator[float], last: float = 0.0) -> list[Values]:
    """Outputs at instants all schedules share, where alone the inputs change; `last` is a step beyond each of them."""
    span, drive = max(interface.step, 5e-3), regime(interface)
    instance.initialise(drive.parameters)
    seen = []
    for k, values in enumerate(drive.script(span)):
        instance.set(values)
        while (k + 1) * span - instance.time > 1e-9:
            assert instance.step(min(next(sizes), (k + 1) * span - instance.time)), instance.messages
        assert not last or instance.step(last), instance.messages
        seen.append(instance.outputs())
    return seen


@pytest.mark.parametrize("schedule", _SCHEDULES)
@every_component
def test_host_steps_do_not_change_the_results(component: Component, fresh: Make, schedule: str) -> None:
    """A sampled FMU gives the same bits; a continuous one integrates other substeps, so the same to its accuracy."""
    interface = component.interface
    expected = _common(fresh(component), interface, repeat(interface.step))
    found = _common(fresh(component), interface, _SCHEDULES[schedule](interface), 1e-13)
    if interface.kind == "sampled":
        assert found == expected
        return
    for ours, theirs in zip(found, expected, strict=True):
        assert ours == pytest.approx(theirs, rel=_ACCURACY, abs=0.1 * _ACCURACY)


_RUN_ALL = """
import json, sys
from pathlib import Path
from fmu_driver import Instance

folder, jobs = Path(sys.argv[1]), json.load(sys.stdin)
instances = [
    Instance(Path(job["file"]), folder / str(k)).initialise(job["parameters"]) for k, job in enumerate(jobs)
]
for k in range(max(len(job["script"]) for job in jobs)):
    for instance, job in zip(instances, jobs):
        if k < len(job["script"]):
            instance.set(job["script"][k])
            assert instance.step(job["step"]), instance.messages
values = {instance.description.modelName: instance.outputs() for instance in instances}
for instance in instances:
    instance.free()
print(json.dumps(values, sort_keys=True))
"""


def _job(component: Component) -> dict[str, object]:
    drive, step = regime(component.interface), component.interface.step
    file = str(cached(component))
    return {"file": file, "parameters": dict(drive.parameters), "step": step, "script": drive.script(step)}


@pytest.mark.skipif(not CATALOGUE, reason="the catalogue is empty")
def test_all_in_one_process_in_several_orders(tmp_path: Path) -> None:
    jobs = [_job(component) for component in CATALOGUE]
    seen = set()
    for k, order in enumerate((jobs, jobs[::-1], random.Random(1).sample(jobs, len(jobs)))):
        done = subprocess.run(
            [sys.executable, "-c", _RUN_ALL, str(tmp_path / str(k))],
            input=json.dumps(order),
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
            check=True,
        )
        assert len(json.loads(done.stdout)) == len(CATALOGUE)
        seen.add(done.stdout)
    assert len(seen) == 1
