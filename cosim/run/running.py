"""One run: prepare, load, initialise, advance, record, measure, and write the results into a folder."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from contextlib import ExitStack, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from cosim.engine.advice import pass_on
from cosim.engine.loader import Loader
from cosim.engine.master import Master
from cosim.engine.moment import check_restorable
from cosim.engine.outcome import Outcome, Status
from cosim.engine.slave import Slave, SlaveError
from cosim.errors import CosimError
from cosim.results.checkpoint import CHECKPOINT
from cosim.results.columns import Texts
from cosim.results.growing import FOOTER, PARTIAL
from cosim.results.provenance import KEY, lines_of_title
from cosim.results.reading import Results, load_results
from cosim.results.recorder import Recorder, recorded
from cosim.results.storage import PARQUET, STREAM
from cosim.results.summary import SUMMARY, Summary, summarise, write_summary
from cosim.run.claim import claimed, unwritable
from cosim.run.facts import facts
from cosim.run.interrupts import interrupts
from cosim.run.prepare import RunPlan, plan
from cosim.run.request import Request
from cosim.run.resuming import BEFORE, check_same, restore, secure, ticks
from cosim.run.volume import expected_rows, remarks
from cosim.scenario.limit import Verdict, judged, missed
from cosim.scenario.metric import Metrics
from fmukit.errors import because

_LOG = logging.getLogger("cosim")
OVERVIEW = "overview.png"
WRITTEN = (SUMMARY, OVERVIEW, PARQUET, STREAM, FOOTER, PARTIAL)
"""What a run leaves in its folder."""
Progress = Callable[[int], None]
"""Is told the simulated time [ns] now and then."""
Load = Callable[[], Mapping[str, Slave]]


@dataclass(frozen=True, slots=True)
class Finished:
    """A run that ended, however it did."""

    plan: RunPlan
    summary: Summary
    results: Results

    def draw(self, file: Path) -> None:
        """Draw the picture of the results into `file`, if the scenario has one; raises OSError."""
        made = self.plan.configured
        if len(self.results.time) > 1:
            lines = [_title(self.plan.request), self._verdict(), self.plan.provenance.text()]
            made.work.draw(self.results, made.prepared, file, "\n".join(filter(None, lines)))

    def _verdict(self) -> str:
        """What a reader must not miss; nothing where all went well."""
        made = self.summary
        return "" if made.status == "ok" else lines_of_title(f"{made.status.upper()}: {made.reason}")


def _title(request: Request) -> str:
    """What the scenario says it is, or with which files of the user it was run instead of its own."""
    files = [Path(value).name for name, value in request.assignments if name.endswith("_file") and value]
    return f"{request.scenario.name} with {', '.join(files)}" if files else request.scenario.title


def run(
    request: Request,
    explain: Callable[[RunPlan], None] = lambda _plan: None,
    progress: Progress = lambda _time: None,
    conclude: Callable[[Finished], None] = lambda _finished: None,
) -> Finished:
    """Run the scenario into its folder. Mistakes of the user raise CosimError before anything runs.

    A slave that fails or an interrupt end the run with that status; what was recorded until then is kept. `conclude` is
    called when the FMUs are gone and the folder still belongs to this run.
    """
    with ExitStack() as claim:
        with Loader(request.find, request.isolate_timeout) as loader:
            made = plan(request, loader)
            explain(made)
            claim.enter_context(claimed(request.folder))
            outcome = execute(made, lambda: loader.slaves(made.nodes), progress)
        finished = _concluded(made, outcome)
        conclude(finished)
    return finished


def execute(made: RunPlan, load: Load, progress: Progress = lambda _time: None) -> Outcome:
    """Load the slaves, initialise and run them, recording into the folder of the request."""
    with interrupts() as interrupted:
        slaves, lost = _loaded(load)
        if made.request.checkpoint_interval:
            check_restorable(slaves)
        check_same(made)
        master = Master(made.nodes, made.schedule, slaves)
        recorder = _recorder(made, master)
        said: Mapping[str, str] = {}
        try:
            if lost:
                raise lost
            master.initialise()
            said = pass_on(slaves)
            restore(made, master, recorder)
            kept, left = partial(_kept, recorder, progress), ticks(made, master, recorder)
            outcome = master.run(made.request.stop, recorder, kept, interrupted, made.pace, left)
        except SlaveError as failure:
            outcome = Outcome("failed", failure.sentence("at initialisation"), 0, 0, {}, {})
        except BaseException:
            with suppress(OSError):
                recorder.close()
            raise
        pass_on(slaves, said, but=outcome.reason)
        return _closed(recorder, outcome)


def _loaded(load: Load) -> tuple[Mapping[str, Slave], SlaveError | None]:
    """The slaves, or how the process of an isolated one was lost on the way."""
    try:
        return load(), None
    except SlaveError as error:
        return {}, error


def _recorder(made: RunPlan, master: Master) -> Recorder:
    """A recorder into a folder that holds nothing of an earlier run."""
    request, about = made.request, {KEY: made.provenance.json().encode()}
    folder = request.folder
    try:
        secure(request)
        for name in (*WRITTEN, *(() if request.resume else (CHECKPOINT, BEFORE))):
            (folder / name).unlink(missing_ok=True)
        kept = recorded(master.signals, request.unrecorded)
        texts = Texts(master.written, master.texts)
        rows = expected_rows(request, made.schedule, made.nodes)
        for remark in remarks(rows, 1 + len(kept) + len(texts.signals), folder):
            _LOG.warning("%s", remark)
        return Recorder(folder, master.vector, master.signals, kept, request.interval, request.stop, about, texts, rows)
    except OSError as error:
        raise unwritable(folder, error) from None


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


def _concluded(made: RunPlan, outcome: Outcome) -> Finished:
    """The results read back and measured, and the summary, which is written beside them."""
    request, configured = made.request, made.configured
    results = load_results(request.folder, facts(made))
    metrics: Metrics = {}
    verdicts: list[Verdict] = []
    try:
        if len(results.time) > 1:
            metrics = configured.work.metrics(results, configured.prepared)
            verdicts = judged(configured.work.limits, metrics)
            outcome = _judged(outcome, "failed", configured.work.failure(results, configured.prepared))
            outcome = _judged(outcome, "missed", missed(verdicts))
    except Exception as error:  # code of the scenario's author, after a run whose results are good
        outcome = _unmeasured(outcome, error)
    about = (request.scenario.name, request.seed, outcome, made.nodes, made.provenance, metrics, verdicts)
    summary = summarise(*about, request.interval, request.unrecorded, made.pace)
    try:
        write_summary(summary, request.folder)
    except OSError as error:
        sentence = f"{request.folder / SUMMARY} cannot be written: {because(error)}"
        summary = replace(summary, status="failed", reason="; ".join(filter(None, [summary.reason, sentence])))
    return Finished(made, summary, results)


def _judged(outcome: Outcome, status: Status, reason: str) -> Outcome:
    """The outcome in the eyes of its scenario: that `status` where it has a reason for it."""
    return replace(outcome, status=status, reason=reason) if reason and outcome.status == "ok" else outcome


def _unmeasured(outcome: Outcome, error: Exception) -> Outcome:
    """The outcome of a run whose metrics could not be computed: failed at least, the reason of the run itself first."""
    kind = "" if isinstance(error, CosimError) else f"{type(error).__name__}: "
    sentence = f"the metrics cannot be computed: {kind}{error}"
    status = "failed" if outcome.status == "ok" else outcome.status
    return replace(outcome, status=status, reason="; ".join(filter(None, [outcome.reason, sentence])))
