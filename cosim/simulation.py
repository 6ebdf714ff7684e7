"""A system stepped by hand, from a script or a notebook.

with Simulation(system, stop_time=10.0) as run:
    while run.step():
        if run["car.position.x"] > 50.0:
            run.set("car.command.speed", 5.0)
table = run.results.table()
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
import pyarrow as pa

from cosim.engine.advice import pass_on
from cosim.engine.loader import Loader
from cosim.engine.master import Master
from cosim.engine.order import Tick
from cosim.engine.slave import SlaveError
from cosim.errors import CosimError
from cosim.model.clock import SECOND, nanoseconds
from cosim.model.face import Value
from cosim.model.system import System
from cosim.model.values import coerce
from cosim.results.columns import Batch, Texts, schema_of
from cosim.results.reading import Results
from cosim.results.recorder import recorded
from cosim.run.facts import facts
from cosim.run.prepare import RunPlan, plan
from cosim.run.request import Request
from cosim.scenario.definition import Scenario
from cosim.scenario.described import Description, scenario_of

_OPTIONS = {
    *("assignments", "seed", "scheme", "step", "events", "isolate", "isolate_timeout", "periods", "replacements"),
    *("event_files", "find"),
}
"""Of `Request`; the others are for runs into folders."""


class Simulation:
    """One run of a system or a scenario, from its initialisation on; a context, in which its FMUs live.

    `stop_time` [s] is needed for a system and may be left out for a scenario. `options` are those of `Request`, such as
    seed=1, scheme="jacobi", step=0.001, assignments=[("car.initial.speed", "15")], but for those on folders. Mistakes,
    and FMUs that fail, raise CosimError.
    """

    def __init__(self, source: System | Scenario, stop_time: float | None = None, **options: Any) -> None:
        if isinstance(source, System):
            if stop_time is None:
                raise CosimError("a system has no stop time of its own; give stop_time in s")
            source = scenario_of(Description("simulation", "", source, stop_time))
        unknown_ = options.keys() - _OPTIONS
        if unknown_:
            raise CosimError(f"a simulation has no {', '.join(sorted(unknown_))}; it has {', '.join(sorted(_OPTIONS))}")
        self._request = Request(source, Path(), stop_time=stop_time, **options)
        self._stack = ExitStack()
        self._open = self._stepping = False
        self._rows: list[np.ndarray] = []
        self._said: list[list[str]] = []
        self._watchers: list[Callable[[Simulation], None]] = []
        self._ended = False

    def __enter__(self) -> Self:
        if self._open or self._ended:
            raise CosimError("a simulation runs once; make another one")
        with ExitStack() as unfinished:
            loader = unfinished.enter_context(Loader(self._request.find, self._request.isolate_timeout))
            self._plan = plan(self._request, loader)
            try:
                self._slaves = loader.slaves(self._plan.nodes)
                self._master = Master(self._plan.nodes, self._plan.schedule, self._slaves)
                self._master.initialise()
            except SlaveError as failure:
                raise CosimError(failure.sentence("at initialisation")) from None
            pass_on(self._slaves)
            self._stack = unfinished.pop_all()
        self._positions = {signal.name: i for i, signal in enumerate(self._master.signals, start=1)}
        self._texts = {signal.name: i for i, signal in enumerate(self._master.written)}
        self._ticks: Iterator[Tick] = self._master.ticks(self._plan.request.stop, self._record)
        self._open = True
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, tb: TracebackType | None) -> None:
        self._ended, self._open = True, False
        self._stack.close()

    @property
    def plan(self) -> RunPlan:
        """The checked instances, in which order they run, and what the run is made of."""
        return self._plan

    @property
    def time(self) -> float:
        """The time [s] of the values that are shown."""
        return float(self._master.vector[0])

    @property
    def signals(self) -> list[str]:
        """Names of what is shown: outputs of all instances, and inputs that events change."""
        return [*self._positions, *self._texts]

    def __getitem__(self, signal: str) -> Any:
        """The newest value of a signal: a number, or the text of a String."""
        if signal in self._texts:
            return self._master.texts[self._texts[signal]]
        if signal not in self._positions:
            raise KeyError(f"no signal {signal}; see Simulation.signals")
        return float(self._master.vector[self._positions[signal]])

    def step(self) -> bool:
        """Go on to the next time at which anything is due, and say whether there was one before the end."""
        if self._ended:
            return False
        self._expect_open()
        if self._stepping:
            raise CosimError("a simulation cannot be stepped by its own watcher")
        self._stepping = True
        try:
            self._advance()
        except BaseException:  # also of a watcher: half a tick has been done, and nothing can go on from there
            self._ended = True
            raise
        finally:
            self._stepping = False
        return not self._ended

    def _advance(self) -> None:
        tick = next(self._ticks, None)
        try:
            if tick is None:
                self._ended = True
                self._master.finish(self._plan.request.stop, self._record)
            else:
                self._master.advance([tick])
        except SlaveError as failure:
            self._ended = True
            if not failure.ended:
                raise CosimError(failure.sentence(f"at {self.time:g} s")) from None

    def _expect_open(self) -> None:
        """Raises CosimError outside the context, where the FMUs are not there."""
        if not self._open:
            raise CosimError("the FMUs of a simulation live in its context; write `with Simulation(...) as run:`")

    def run_until(self, time: float) -> bool:
        """Step until `time` [s] has been reached, and say whether the end has not."""
        until = nanoseconds(time, "the time to run to") if time else 0
        going = not self._ended
        while going and round(self.time * SECOND) < until:
            going = self.step()
        return going

    def set(self, signal: str, value: Value) -> None:
        """Give an input that nothing feeds another value, which the instance takes in with its next step."""
        self._expect_open()
        system = self._plan.configured.configuration.system
        instance, variable = system.split(signal)
        node = self._plan.nodes[instance]
        port = node.face.ports.get(variable)
        if port is None or port.causality != "input" or variable in node.incoming or variable in node.faults:
            raise CosimError(f"{signal} cannot be set: it is no input that nothing feeds")
        try:
            self._master.set(instance, {variable: coerce(signal, port, value)})
        except SlaveError as failure:
            raise CosimError(failure.sentence(f"at {self.time:g} s")) from None

    def watch(self, watcher: Callable[[Simulation], None]) -> None:
        """Call `watcher` with this simulation after every recorded row."""
        self._watchers.append(watcher)

    @property
    def results(self) -> Results:
        """What has been recorded so far."""
        chosen = recorded(self._master.signals, self._request.unrecorded)
        texts = Texts(self._master.written, self._master.texts)
        schema = schema_of([*(self._master.signals[i] for i in chosen), *texts.signals])
        rows = np.array(self._rows).reshape(len(self._rows), len(self._master.vector))
        columns = rows[:, [0, *(1 + i for i in chosen)]].T
        batch = Batch(np.ascontiguousarray(columns), schema).first(len(self._rows), self._said)
        return Results(pa.Table.from_batches([batch]), facts(self._plan, self.time))

    def _record(self) -> None:
        self._rows.append(self._master.vector.copy())
        self._said.append(list(self._master.texts))
        for watcher in self._watchers:
            watcher(self)
