"""An FMU computes the same bits as its kernel called directly, and instances share nothing."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import demo_filter
import demo_spring
import numpy as np
from fmu_driver import Instance

from fmukit import direct
from fmukit.direct import Direct
from fmukit.runtime import stepping

Make = Callable[[str], Instance]


def _spring(instance: Instance, count: int = 40) -> list[dict[str, float]]:
    trajectory = [instance.outputs()]
    for k in range(count):
        instance.set({"force": 20.0 * math.sin(0.3 * k)})
        assert instance.step(0.0025 if k % 3 else 1e-3)
        trajectory.append(instance.outputs())
    return trajectory


def test_continuous_trajectory_is_bit_identical(make: Make) -> None:
    parameters = {"mass": 1.7, "initial.position": 0.1}
    trajectory = _spring(make("DemoSpring").initialise(parameters))
    reference = Direct(demo_spring.COMPONENT, parameters)
    for k, seen in enumerate(trajectory):
        assert seen.pop("fault") == 0
        assert seen == reference.outputs()
        reference.set({"force": 20.0 * math.sin(0.3 * k)})
        reference.advance(0.0025 if k % 3 else 1e-3)


def test_sampled_trajectory_is_bit_identical(make: Make, tmp_path: Path) -> None:
    table = np.array([[0.0, 1.0], [0.02, 3.0], [0.05, -2.0]])
    file = tmp_path / "profile.csv"
    file.write_text("time,level\n" + "".join(f"{t},{value}\n" for t, value in table))
    parameters = {"seed": 12345, "sigma": 0.3, "sample_period": 0.007}
    instance = make("DemoFilter").initialise({**parameters, "profile_file": str(file)})
    reference = Direct(demo_filter.COMPONENT, parameters, table=table)
    for k in range(50):
        seen = instance.outputs()
        assert seen.pop("fault") == 0
        assert seen == reference.outputs()
        values = {"measured": math.cos(0.1 * k)}
        instance.set(values)
        assert instance.step(0.007)
        reference.set(values)
        reference.sample(0.007)
    assert seen["level"] == -2.0


def test_spring_follows_its_closed_solution(make: Make) -> None:
    instance = make("DemoSpring").initialise({"mass": 2.0, "stiffness": 50.0, "initial.position": 0.25})
    for _ in range(1000):
        assert instance.step(1e-3)
    omega = 5.0
    assert abs(instance["position"] - 0.25 * math.cos(omega)) < 1e-9
    assert abs(instance["speed"] + 0.25 * omega * math.sin(omega)) < 1e-9


def test_boolean_parameter_reaches_the_kernel(make: Make) -> None:
    instance = make("DemoSpring").initialise({"spring.enabled": False})
    assert instance.step(1.0)
    assert instance["position"] == 0.25


def test_substeps_agree_with_direct() -> None:
    for longest in (1e-3, 3e-4, 0.1):
        for duration in (1e-13, 1e-3, 1e-3 * (1 + 1e-12), 0.99999999999945e-3, 2.5e-3, 0.1, 0.30000000000000004):
            assert stepping.substeps(duration, longest) == direct.substeps(duration, longest)


def test_interleaved_instances_equal_each_alone(make: Make) -> None:
    settings = [{"seed": 1}, {"seed": 2, "time_constant": 0.5}]
    alone = []
    for parameters in settings:
        instance = make("DemoFilter").initialise(parameters)
        alone.append([(instance.step(5e-3), instance.outputs()) for _ in range(20)])
    pair = [make("DemoFilter").initialise(parameters) for parameters in settings]
    together = [[(instance.step(5e-3), instance.outputs()) for instance in pair] for _ in range(20)]
    assert [list(one) for one in zip(*together, strict=True)] == alone
    assert alone[0] != alone[1]


def test_reset_repeats(make: Make) -> None:
    instance = make("DemoSpring").initialise({"mass": 3.0})
    first = _spring(instance)
    instance.set({"force": math.nan})
    instance.fmu.reset()
    assert instance["mass"] == 2.0
    assert instance["fault"] == 0
    assert _spring(instance.initialise({"mass": 3.0})) == first


def test_outputs_read_during_initialisation_belong_to_the_values_set(make: Make) -> None:
    instance = make("DemoSpring")
    instance.fmu.setupExperiment()
    instance.fmu.enterInitializationMode()
    assert instance["position"] == 0.25
    instance.set({"initial.position": -0.5})
    assert instance["position"] == -0.5
    instance.fmu.exitInitializationMode()
    assert instance["position"] == -0.5
