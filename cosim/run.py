"""One run: check the system, load, initialise, advance, record, measure and write the results."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from cosim.engine.advice import pass_on
from cosim.engine.loader import Loader
from cosim.engine.master import Master, Outcome
from cosim.engine.schedule import Schedule, Scheme, schedule
from cosim.engine.slave import Slave, SlaveError
from cosim.errors import CosimError, because
from cosim.model.assembly import Node, assemble, leave_out
from cosim.model.clock import SECOND, nanoseconds, to_seconds
from cosim.model.system import System
from cosim.results.reading import Results, load_results
from cosim.results.recorder import Recorder, recorded
from cosim.results.storage import PARQUET, STREAM
from cosim.results.summary import SUMMARY, summarise, write_summary
from cosim.scenario import Scenario, chosen, configured

OVERVIEW = "overview.png"
WRITTEN = (SUMMARY, OVERVIEW, PARQUET, STREAM)  # what a run leaves in its folder
Progress = Callable[[int], None]
Load = Callable[[], Mapping[str, Slave]]


@dataclass(frozen=True, slots=True)
class Plan:
    """What is going to run: shown by --explain. `stop` and `record_every` [ns]; 0 records at every tick.

    Signals that match a pattern of `unrecorded` are not recorded.
    """

    scenario: Scenario
    nodes: dict[str, Node]
    schedule: Schedule
    stop: int
    seed: int
    record_every: int = 0
    unrecorded: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class Request:
    """What the user asked for: `assignments` are (instance.variable or scenario.setting, text).

    `step` [s], if given, is the communication step of all instances instead of a period for each. `events` are
    (time [s], instance.variable, text), besides those of the scenario. `record_every` [s] in place of the scenario's.
    `record_all` records what the scenario leaves out, too.
    """

    scenario: Scenario
    folder: Path
    assignments: Sequence[tuple[str, str]] = ()
    seed: int = 0
    stop_time: float | None = None
    scheme: Scheme = "multirate"
    step: float | None = None
    events: Sequence[tuple[float, str, str]] = ()
    record_every: float | None = None
    record_all: bool = False

    @property
    def stop(self) -> int:
        """The end of the run [ns]."""
        seconds = self.scenario.stop_time if self.stop_time is None else self.stop_time
        return nanoseconds(seconds, "the stop time")

    @property
    def interval(self) -> int:
        """The time between two recorded rows [ns], 0 for a row at every tick."""
        seconds = self.scenario.record_every if self.record_every is None else self.record_every
        return nanoseconds(seconds, "the time between two recorded rows") if seconds else 0


def run(
    request: Request,
    explain: Callable[[Plan], None] = lambda _plan: None,
    progress: Progress = lambda _time: None,
) -> tuple[dict[str, Any], Results]:
    """Run the scenario into its folder; gives the summary and the results. User mistakes raise CosimError.

    A slave that fails or an interrupt end the run with that status; what was recorded until then is kept.
    """
    scenario, stop, interval = request.scenario, request.stop, request.interval
    unrecorded = () if request.record_all else scenario.unrecorded
    system = requested(request)
    with Loader(scenario.find) as loader:
        nodes = assemble(system, loader.faces(system), request.seed, request.step)
        in_time(request, system, nodes)
        leave_out(nodes, unrecorded)
        plan = Plan(scenario, nodes, schedule(nodes, request.scheme), stop, request.seed, interval, unrecorded)
        explain(plan)
        outcome = execute(plan, lambda: loader.slaves(system, nodes), request.folder, progress)
    return _conclude(plan, outcome, request)


def requested(request: Request) -> System:
    """The scenario's system with the user's values and events."""
    system = configured(request.scenario, request.assignments)
    for time, signal_, value in request.events:
        system.at(time, signal_, value)
    return system


def in_time(request: Request, system: System, nodes: Mapping[str, Node]) -> None:
    """Raises CosimError for an event of the user that the run would not reach; those of a scenario may be cut off."""
    found = [(time, *each) for time, signal_, _ in request.events for each in system.selected(signal_)]
    stop, asked = request.stop, {(round(time * SECOND), f"{name}.{variable}") for time, name, variable, _ in found}
    for node in nodes.values():
        for change in node.changes:
            name = f"{node.name}.{change.variable}"
            if (change.time, name) in asked and change.due >= stop:
                raise CosimError(
                    f"{name} cannot be set at {to_seconds(change.time):g} s: the run ends at {to_seconds(stop):g} s, "
                    f"and {node.name} would take it in at {to_seconds(change.due):g} s"
                )


def execute(plan: Plan, load: Load, folder: Path, progress: Progress = lambda _time: None) -> Outcome:
    """Load the slaves, initialise and run them, recording into `folder`."""
    with _interrupts() as interrupted:
        slaves = load()
        master = Master(plan.nodes, plan.schedule, slaves)
        recorder = _recorder(folder, master, plan)
        try:
            master.initialise()
            pass_on(slaves)
            outcome = master.run(plan.stop, recorder, partial(_kept, recorder, progress), interrupted)
        except SlaveError as failure:
            outcome = Outcome("failed", failure.sentence("at initialisation"), 0, 0, {}, {})
        except BaseException:
            with suppress(OSError):
                recorder.close()
            raise
        return _closed(recorder, outcome)


def _recorder(folder: Path, master: Master, plan: Plan) -> Recorder:
    """A recorder into a folder that holds nothing of an earlier run."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name in WRITTEN:
            (folder / name).unlink(missing_ok=True)
        kept = recorded(master.signals, plan.unrecorded)
        return Recorder(folder, master.vector, master.signals, kept, plan.record_every, plan.stop)
    except OSError as error:
        raise CosimError(f"cannot write into {error.filename or folder}: {because(error)}") from None


def _closed(recorder: Recorder, outcome: Outcome) -> Outcome:
    try:
        recorder.close()
    except OSError as error:
        if outcome.status != "failed":
            return replace(outcome, status="failed", reason=f"the results cannot be written: {because(error)}")
    return outcome


def _kept(recorder: Recorder, progress: Progress, time: int) -> None:
    recorder.keep()
    progress(time)


def _conclude(plan: Plan, outcome: Outcome, request: Request) -> tuple[dict[str, Any], Results]:
    folder, settings = request.folder, chosen(request.scenario, request.assignments)
    periods = {name: node.period / SECOND for name, node in plan.nodes.items()}
    values = {name: node.values for name, node in plan.nodes.items()}
    results = load_results(folder, periods, settings, values, to_seconds(plan.stop))
    metrics = plan.scenario.metrics(results) if len(results.time) > 1 else {}
    summary = summarise(plan.scenario.name, plan.seed, outcome, plan.nodes, metrics, plan.record_every, plan.unrecorded)
    try:
        write_summary(summary, folder)
    except OSError as error:
        reasons = [summary["reason"], f"{folder / SUMMARY} cannot be written: {because(error)}"]
        summary |= {"status": "failed", "reason": "; ".join(filter(None, reasons))}
    return summary, results


@contextmanager
def _interrupts() -> Iterator[Callable[[], bool]]:
    """A flag that Ctrl-C and SIGTERM raise; a second Ctrl-C acts at once.

    An exception would surface inside whichever FMU happens to run Python code, and be taken for its fault.
    """
    asked = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield asked.is_set
        return

    def ask(number: int, _frame: object) -> None:
        asked.set()
        signal.signal(number, previous[number])

    kinds = (signal.SIGINT, signal.SIGTERM)
    previous: dict[int, Any] = {kind: signal.signal(kind, ask) for kind in kinds}
    try:
        yield asked.is_set
    finally:
        for kind in kinds:
            signal.signal(kind, previous[kind])
