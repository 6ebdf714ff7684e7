"""Slaves made of lambdas, to drive the master without FMUs, and scenarios made of functions."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from cosim.engine.master import Master
from cosim.engine.outcome import Outcome
from cosim.engine.schedule import Scheme, schedule
from cosim.engine.slave import Calls, Memory, SlaveError
from cosim.model.assembly import assemble
from cosim.model.clock import SECOND
from cosim.model.configuration import Configuration
from cosim.model.face import Face, Port, Value
from cosim.model.node import Node
from cosim.model.system import System
from cosim.model.units import Unit
from cosim.run.prepare import Configured, RunPlan
from cosim.run.request import Request
from cosim.scenario.definition import Scenario, Work

Step = Callable[[float, float, dict[str, float]], "dict[str, float] | int"]

RADIAN = Unit("rad", (0, 0, 0, 0, 0, 0, 0, 1))
UNITS = {
    unit.name: unit
    for unit in (
        Unit("m", (0, 1, 0, 0, 0, 0, 0, 0)),
        Unit("mm", (0, 1, 0, 0, 0, 0, 0, 0), 1e-3),
        Unit("K", (0, 0, 0, 0, 1, 0, 0, 0)),
        Unit("degC", (0, 0, 0, 0, 1, 0, 0, 0), 1.0, 273.15),
        Unit("s", (0, 0, 1, 0, 0, 0, 0, 0)),
        RADIAN,
        Unit("deg", RADIAN.exponents, 3.141592653589793 / 180.0),
    )
}


def face(
    inputs: Mapping[str, str] | None = None,
    outputs: Mapping[str, str] | None = None,
    *,
    step: float = 0.01,
    continuous: bool = False,
    extra: tuple[Port, ...] = (),
) -> Face:
    """A face from {name: unit}; value references count up."""
    ports = [Port(name, 0, "input", unit=unit) for name, unit in (inputs or {}).items()]
    variability = "continuous" if continuous else "discrete"
    ports += [Port(name, 0, "output", variability=variability, unit=unit) for name, unit in (outputs or {}).items()]
    return Face("Mock", {port.name: port for port in (*ports, *extra)}, step, UNITS)


class Mock:
    """`step(time, length, inputs)` returns outputs by name, or an fmi2Status; `log` notes every event."""

    def __init__(self, face: Face, step: Step, initial: Mapping[str, float] | None = None) -> None:
        self.face = face
        self.log: list[tuple[object, ...]] = []
        self.steps: list[tuple[float, float, dict[str, float]]] = []
        self.reason = ""
        self.refuses = False
        self.closed = False
        self._step = step
        self._outputs = dict.fromkeys(face.outputs, 0.0) | dict(initial or {})

    def set(self, values: Mapping[str, Value]) -> None:
        self.log.append(("set", dict(values)))

    def enter(self) -> None:
        self.log.append(("enter",))
        if self.refuses:
            raise SlaveError("mock", 3, self.reason)

    def leave(self) -> None:
        self.log.append(("leave",))

    def bind(self, memory: Memory) -> Calls:
        held: dict[str, float] = {}

        def set_() -> int:
            held.update(zip(memory.inputs, memory.u.tolist(), strict=True))
            return 0

        def step() -> int:
            time, length = memory.time.value, memory.step.value
            self.steps.append((time, length, dict(held)))
            self.log.append(("step", time))
            result = self._step(time, length, held)
            if isinstance(result, int):
                return result
            self._outputs.update(result)
            return 0

        def get() -> int:
            memory.y[:] = [self._outputs[name] for name in memory.outputs]
            return 0

        return Calls(set_, step, get)

    def failed(self, status: int) -> None:
        self.log.append(("failed", status))

    def ended(self) -> bool:
        return False

    def message(self) -> str:
        return self.reason

    def close(self) -> None:
        self.closed = True


def assembled(system: System, faces: Mapping[str, Face], seed: int = 0, step: float | None = None) -> dict[str, Node]:
    """The nodes of `system` with all that is set of it, on models with these faces."""
    return assemble(Configuration(system, faces), seed, step)


def faces_of(mocks: Mapping[str, Mock]) -> dict[str, Face]:
    return {name: mock.face for name, mock in mocks.items()}


def scenario_of(name: str, build: Callable[..., System], *, stop_time: float = 1.0, **options: Any) -> Scenario:
    """A scenario whose work is `build(settings, prepared)`; options of `Work` and of `Scenario` by their names."""
    module = ModuleType(f"scenario_{name}")
    steps = {
        step: options.pop(step) for step in ("prepare", "complete", "metrics", "limits", "picture") if step in options
    }
    module.WORK = Work(build, **steps)  # type: ignore[attr-defined]
    sys.modules[module.__name__] = module
    return Scenario(name, options.pop("title", name), "none", stop_time, module.__name__, **options)


def plan_of(
    system: System, mocks: Mapping[str, Mock], folder: Path = Path(), *, stop: float = 1.0, scheme: Scheme = "multirate"
) -> RunPlan:
    """What is going to run: `system` on the mocks, to `stop` [s], into `folder`."""
    configuration = Configuration(system, faces_of(mocks))
    scenario = scenario_of("mocked", lambda settings, prepared: system, stop_time=stop)
    nodes = assemble(configuration, 0)
    made = Configured(scenario.work(), {}, configuration, None)
    return RunPlan(Request(scenario, folder, scheme=scheme), made, nodes, schedule(nodes, scheme))


def mastered(
    system: System, mocks: Mapping[str, Mock], scheme: Scheme = "multirate", step: float | None = None
) -> tuple[Master, dict[str, Node]]:
    """An initialised master on the mocks."""
    nodes = assembled(system, faces_of(mocks), 0, step)
    master = Master(nodes, schedule(nodes, scheme), dict(mocks))
    master.initialise()
    return master, nodes


def simulate(
    system: System, mocks: Mapping[str, Mock], stop: float, scheme: Scheme = "multirate", step: float | None = None
) -> tuple[Outcome, list[dict[str, float]]]:
    """Run to `stop` [s]; the rows recorded, by signal name."""
    master, _ = mastered(system, mocks, scheme, step)
    rows: list[dict[str, float]] = []
    names = ["time", *(signal.name for signal in master.signals)]
    outcome = master.run(
        round(stop * SECOND), lambda: rows.append(dict(zip(names, master.vector.tolist(), strict=True)))
    )
    return outcome, rows
