"""The multirate master: integer time, one signal vector, and at each tick a flat list of bound calls.

At a tick t: parallel slaves whose step ends at t publish their outputs; due sequential slaves run in dataflow order,
each reading the newest signals; the recorder takes a row; due parallel slaves take their inputs and step together, and
keep their outputs for the end of the step.
Inputs that events change are set just before their slave takes its other inputs.
Sequential are the sampled slaves and parallel the continuous ones; with the scheme "jacobi" all are parallel.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from ctypes import c_double
from functools import partial
from itertools import islice
from time import perf_counter_ns

import numpy as np

from cosim.engine import changes
from cosim.engine.binding import Shown, bind
from cosim.engine.bound import Bound
from cosim.engine.giving import giving
from cosim.engine.moment import Moment, put_back, taken
from cosim.engine.order import Action, Order, Tick
from cosim.engine.outcome import Outcome, judged
from cosim.engine.pace import Pace
from cosim.engine.schedule import Schedule, active_ticks
from cosim.engine.shaping import shapers
from cosim.engine.slave import Slave, SlaveError, do_nothing
from cosim.model.clock import SECOND, to_seconds
from cosim.model.face import Value
from cosim.model.node import Node
from cosim.model.signals import Vector
from fmukit.errors import because

_BLOCK = 64  # ticks between two looks at the interrupt flag and the progress display


class Master:
    """Runs the nodes on `slaves` (same names). `signals` describes `vector[1:]`; `vector[0]` is the time [s].

    `written` describes `texts`, the values of String outputs.
    """

    def __init__(self, nodes: Mapping[str, Node], schedule: Schedule, slaves: Mapping[str, Slave]) -> None:
        self.schedule = schedule
        outputs = [node.signal(name) for node in nodes.values() for name in node.outputs]
        changed = [node.signal(name) for node in nodes.values() for name in changes.shown(node)]
        self.signals = outputs + changed
        self.vector: Vector = np.zeros(1 + len(self.signals))
        self.vector[1 + len(outputs) :] = [changes.start(nodes[signal.instance], signal.variable) for signal in changed]
        self._time = c_double.from_buffer(self.vector.data)
        self._index = {signal.name: i for i, signal in enumerate(self.signals, start=1)}
        self.written = [node.signal(name) for node in nodes.values() for name in node.texts]
        self.texts = [""] * len(self.written)
        self._nodes, self._slaves = nodes, slaves
        words = {signal.name: i for i, signal in enumerate(self.written)}
        self._shown = Shown(self._time, self.vector, self._index, self.texts, words)
        self._bound: dict[str, Bound] = {}
        self._shapers = {name: shapers(node, self.vector, self._index) for name, node in nodes.items()}

    def initialise(self) -> None:
        """Set parameters, enter initialisation, pass outputs to inputs along the dataflow, leave; or SlaveError."""
        for name in self.schedule.initial:
            self._slaves[name].set(self._nodes[name].values)
        for name in self.schedule.initial:
            self._slaves[name].enter()
            self._bound[name] = bind(self._nodes[name], self._slaves[name], self._shown, name in self.schedule.parallel)
        numbers, texts = (self.vector, self._index), (self.texts, self._shown.words)
        givers = {name: giving(node, self._slaves[name], numbers, texts) for name, node in self._nodes.items()}
        self._propagate({}, leave=False)  # before anything is given what nobody has calculated yet
        self._propagate(givers, leave=False)
        self._propagate(givers, leave=True)
        for shaper in (each for own in self._shapers.values() for each in own):
            shaper.begin_anew()  # what began on values that nobody had calculated yet

    def run(
        self,
        stop: int,
        record: Action,
        progress: Callable[[int], None] = lambda _time: None,
        interrupted: Callable[[], bool] = lambda: False,
        pace: Pace | None = None,
        ticks: Iterator[Tick] | None = None,
    ) -> Outcome:
        """Advance to `stop` [ns]; `record` is called per active tick and once at the end.

        `ticks` take the place of those from 0 on.

        With a `pace` it keeps to the clock on the wall, as far as it can.

        A slave that fails, or a recorder that cannot write (OSError), ends the run with status "failed"; one that wants
        the simulation to end, with "ok".
        """
        start = perf_counter_ns()
        status, reason, begun = "ok", "", round(self._time.value * SECOND)
        time = begun
        ticks, block = ticks or self.ticks(stop, record), _BLOCK
        if pace is not None:
            ticks, block = pace.paced(ticks, interrupted), 1
        try:
            time = self._loop(ticks, progress, interrupted, stop, block)
            if time < stop:
                status, reason = "interrupted", f"interrupted at {to_seconds(time):g} s"
            else:
                self.finish(stop, record)
        except SlaveError as failure:
            time = round(self._time.value * SECOND)
            status, reason = judged(failure, f"at {to_seconds(time):g} s")
        except OSError as error:
            time = round(self._time.value * SECOND)
            status, reason = "failed", f"the results cannot be written at {to_seconds(time):g} s: {because(error)}"
        wall = perf_counter_ns() - start
        calls = {name: bound.count for name, bound in self._bound.items()}
        times = {name: bound.time for name, bound in self._bound.items()}
        return Outcome(status, reason, time, wall, calls, times, begun)  # type: ignore[arg-type]

    def _loop(
        self,
        ticks: Iterator[Tick],
        progress: Callable[[int], None],
        interrupted: Callable[[], bool],
        stop: int,
        size: int,
    ) -> int:
        time = round(self._time.value * SECOND)
        while not interrupted():
            block = list(islice(ticks, size))
            time = self.advance(block, time)
            progress(time)
            if len(block) < size:
                return stop
        return time

    def advance(self, ticks: Iterable[Tick], reached: int = 0) -> int:
        """Do what is due at the ticks; the time [ns] of the last, `reached` if there is none.

        Raises SlaveError, or OSError of the recorder.
        """
        clock = self._time
        for time, order in ticks:
            clock.value = time / SECOND
            for action in order.actions:
                action()
            reached = time
        return reached

    def ticks(self, stop: int, record: Action) -> Iterator[Tick]:
        """(time, what to do) in time order up to `stop` [ns], with what events do."""
        return changes.merged(self._ticks(stop, record), self._changes())

    def _ticks(self, stop: int, record: Action) -> Iterator[Tick]:
        """(time, what to do) in time order; the last steps of the parallel slaves are cut to end at `stop`."""
        cycle = self._cycle(min(self.schedule.cycle, stop), record)
        tail = stop - max((self._nodes[name].period for name in self.schedule.parallel), default=0)
        for start in range(0, stop, self.schedule.cycle):
            for offset, order in cycle:
                time = start + offset
                if time > tail:
                    if time >= stop:
                        return
                    yield time, order.framed([partial(self._cut, time, stop)])
                else:
                    yield time, order

    def _changes(self) -> list[changes.Due]:
        """Everything events do, in the order of their instances: sequential ones first."""
        names = self.schedule.sequential + self.schedule.parallel
        found = [(self._nodes[name], change) for name in names for change in self._nodes[name].changes]
        return [
            changes.Due(
                time=change.due,
                early=node.name in self.schedule.sequential,
                set=partial(self._slaves[node.name].set, {change.variable: change.value}),
                show=changes.writer(self.vector, self._index.get(f"{node.name}.{change.variable}"), change.value),
            )
            for node, change in found
        ]

    def _cut(self, time: int, stop: int) -> None:
        for name in self.schedule.parallel:
            period = self._nodes[name].period
            if time % period == 0:
                self._bound[name].step.value = to_seconds(min(period, stop - time))

    def _cycle(self, end: int, record: Action) -> list[Tick]:
        """One whole cycle, with one shared order per set of due instances."""
        periods = {name: self._nodes[name].period for name in self.schedule.initial}
        orders: dict[tuple[str, ...], Order] = {}
        cycle = []
        for time, due in active_ticks(periods, end):
            if due not in orders:
                orders[due] = self._order(set(due), record)
            cycle.append((time, orders[due]))
        return cycle

    def _order(self, due: set[str], record: Action) -> Order:
        parallel = [self._bound[name] for name in self.schedule.parallel if name in due]
        sequential = [action for name in self.schedule.sequential if name in due for action in self._now(name)]
        published = [bound.publish for bound in parallel]
        shaped = [shape for bound in parallel for shape in self._shapers[bound.node.name]]
        return Order([*published, *sequential, *shaped], record, [bound.exchange for bound in parallel])

    def _now(self, name: str) -> list[Action]:
        """What a sequential slave does at a tick."""
        bound = self._bound[name]
        return [*self._shapers[name], bound.exchange, *([] if bound.publish is do_nothing else [bound.publish])]

    def set(self, instance: str, values: Mapping[str, Value]) -> None:
        """Give inputs that nothing feeds, or tunable parameters, other values between two ticks; raises SlaveError."""
        self._slaves[instance].set(values)
        for name, value in values.items():
            place = self._index.get(f"{instance}.{name}")
            changes.writer(self.vector, place, value)()

    def moment(self, time: int) -> Moment:
        """All that is needed to go on with the tick at `time` [ns]; raises SlaveError."""
        return taken(time, self.vector, self._index, self.texts, self._bound, self._shapers)

    def put_back(self, moment: Moment) -> None:
        """Once initialised, be as at the moment; raises SlaveError."""
        put_back(moment, self.vector, self._index, self.texts, self._bound, self._shapers)

    def finish(self, stop: int, record: Action) -> None:
        """Show what belongs to the end of the last steps, and record a last row."""
        self._time.value = to_seconds(stop)
        for name in self.schedule.parallel:
            self._bound[name].publish()
        record()

    def _propagate(self, givers: Mapping[str, Action], *, leave: bool) -> None:
        for name in self.schedule.initial:
            bound = self._bound[name]
            givers.get(name, do_nothing)()
            for shape in self._shapers[name]:
                shape()
            bound.gather()
            bound.check(bound.calls.set())
            if leave:
                self._slaves[name].leave()
            bound.check(bound.calls.get())
            bound.publish()
