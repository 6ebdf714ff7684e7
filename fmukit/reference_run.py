"""What a component is shown doing: a short run from its start values, declared as data in `reference_run.py` beside it.

The plot in the FMU's documentation and the cross-check bundle are made of it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec

from fmukit.component import Component
from fmukit.interface import Interface


def at_start(t: float) -> dict[str, float]:
    """All inputs keep their start values."""
    return {}


@dataclass(frozen=True, slots=True)
class ReferenceRun:
    """`text` is one sentence for the reader; `stop` and the communication step `step` are in seconds.

    `inputs(t)` gives the inputs at time t by name, the others keep their start values; they are held over a step.
    `plots` names the outputs of each panel, all of one unit, by the panel's title. Parameters keep their start values.
    """

    text: str
    stop: float
    step: float
    plots: Mapping[str, tuple[str, ...]]
    inputs: Callable[[float], Mapping[str, float]] = at_start


def reference_run(component: Component) -> ReferenceRun | None:
    """`RUN` of the module `reference_run` beside the component's model; None when there is no such module."""
    package = component.model.rpartition(".")[0]
    name = f"{package}.reference_run"
    if not package or find_spec(name) is None:
        return None
    run: ReferenceRun = import_module(name).RUN
    _check(component.interface, run)
    return run


def _check(interface: Interface, run: ReferenceRun) -> None:
    known = {variable.name: variable.unit for variable in interface.select("output")}
    for title, names in run.plots.items():
        unknown = [name for name in names if name not in known]
        if unknown:
            raise ValueError(f"{interface.name}: panel {title!r} shows {unknown[0]}, which is not an output")
        if len({known[name] for name in names}) != 1:
            raise ValueError(f"{interface.name}: panel {title!r} needs outputs of one unit")


def rise(t: float, start: float, duration: float) -> float:
    """From 0 to 1 between `start` and `start` + `duration` [s], twice continuously differentiable."""
    xi = min(max((t - start) / duration, 0.0), 1.0)
    return xi**3 * (10.0 + xi * (6.0 * xi - 15.0))
