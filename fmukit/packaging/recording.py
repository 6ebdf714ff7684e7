"""A component's reference run, computed from its kernel: no FMU and no compiler are needed for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fmukit.component import Component
from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmukit.python_kernel import PythonKernel
from fmukit.reference_run import ReferenceRun, reference_run

_DIGITS = 9


@dataclass(frozen=True, slots=True)
class Recording:
    """`times` (n,) [s]; `inputs` and `outputs` by name, each (n,), in the units of the interface, `fault` left out."""

    run: ReferenceRun
    times: np.ndarray
    inputs: dict[str, np.ndarray]
    outputs: dict[str, np.ndarray]


def shown(value: float) -> str:
    """A number as it stands in files: nine digits."""
    return f"{value:.{_DIGITS}g}"


def recorded(component: Component, kernel: Kernel | PythonKernel) -> Recording | None:
    """The component's reference run, played; None when it declares none."""
    run = reference_run(component)
    return None if run is None else record(component, kernel, run)


def record(component: Component, kernel: Kernel | PythonKernel, run: ReferenceRun) -> Recording:
    """Play the run; inputs are rounded to the digits of a file first, so that a file of them gives the same run."""
    times = np.round(np.arange(round(run.stop / run.step) + 1) * run.step, _DIGITS)
    starts = {variable.name: float(variable.start) for variable in component.interface.select("input")}
    script = [_rounded(starts | dict(run.inputs(float(t)))) for t in times]
    instance = Direct(component, inputs=script[0], kernel=kernel)
    seen = [instance.outputs()]
    for values in script[:-1]:
        instance.set(values)
        _step(instance, run.step)
        seen.append(instance.outputs())
    return Recording(run, times, _columns(script), _columns(seen))


def _rounded(values: Mapping[str, float]) -> dict[str, float]:
    return {name: float(shown(value)) for name, value in values.items()}


def _step(instance: Direct, duration: float) -> None:
    interface = instance.interface
    if interface.kind == "continuous":
        instance.advance(duration)
        return
    samples = round(duration / interface.step)
    if abs(samples * interface.step - duration) > 1e-9 * duration:
        raise ValueError(f"{interface.name}: step {duration} of the reference run is no multiple of {interface.step}")
    for _ in range(samples):
        instance.sample()


def _columns(rows: list[dict[str, float]]) -> dict[str, np.ndarray]:
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
