"""Going on with a run from its checkpoint, or branching off there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from pyarrow import parquet

from cosim.engine.master import Master
from cosim.engine.order import Tick
from cosim.errors import CosimError
from cosim.model.clock import SECOND, to_seconds
from cosim.model.face import Port, Value
from cosim.model.values import coerce
from cosim.results.checkpoint import Checkpoint, Resumed, absolute, read_checkpoint, write_checkpoint
from cosim.results.reading import load_results
from cosim.results.recorder import Recorder
from cosim.run.prepare import RunPlan
from cosim.run.request import Request

BEFORE = "results.before"
"""What had been recorded when a run was resumed, until it is in its results again."""
_KEPT = (
    "assignments", "seed", "stop_time", "scheme", "step", "events", "record_every", "record_all", "isolate",
    "isolate_timeout", "periods", "checkpoint",
)  # fmt: skip


def asked(request: Request) -> dict[str, Any]:
    """The request in plain values, from which `again` makes it anew in any folder."""
    plain = {key: getattr(request, key) for key in _KEPT}
    return plain | {
        "origin": _origin(request.origin or request.scenario.name),
        "assignments": [
            (name, absolute(text) if name.endswith("_file") else text) for name, text in request.assignments
        ],
        "replacements": [(name, absolute(str(file))) for name, file in request.replacements],
        "event_files": [absolute(name) if name.endswith(".toml") else name for name in request.event_files],
    }


def _origin(name: str) -> str:
    """What the user named, so that it means the same from any folder."""
    file, mark, rest = name.partition("#")
    is_file = Path(file).suffix.lower() in (".toml", ".ssp", ".ssd") or Path(file, "SystemStructure.ssd").is_file()
    return f"{absolute(file)}{mark}{rest}" if is_file else name


def resumed(folder: Path, changes: Sequence[tuple[str, str]] = ()) -> tuple[str, dict[str, Any], Resumed]:
    """What was run into the folder, the options of its request, and where it goes on; raises CosimError."""
    kept = read_checkpoint(folder)
    options = dict(kept.asked)
    origin = options.pop("origin")
    pairs = ("assignments", "events", "periods", "replacements")
    options |= {key: [tuple(pair) for pair in options[key]] for key in pairs}
    options["replacements"] = [(name, Path(file)) for name, file in options["replacements"]]
    before = folder / BEFORE
    table = parquet.read_table(before) if before.is_file() else load_results(folder).table()
    if table.num_rows < kept.rows:
        raise CosimError(f"{folder} holds fewer rows than its checkpoint says; begin the run anew")
    return origin, options, Resumed(kept, table.slice(0, kept.rows), tuple(changes))


def secure(request: Request) -> None:
    """Before anything is removed from the folder, keep what had been recorded in a file of its own; raises OSError."""
    if request.resume is not None:
        before, new = request.folder / BEFORE, request.folder / f"{BEFORE}.new"
        parquet.write_table(request.resume.table, new)
        new.replace(before)


def restore(made: RunPlan, master: Master, recorder: Recorder) -> None:
    """Bring the initialised master and the new recorder to the checkpoint of the plan; raises CosimError."""
    again = made.request.resume
    if again is None:
        return
    moment = again.checkpoint.moment
    recorder.refill(again.table)
    recorder.flush()
    (made.request.folder / BEFORE).unlink()
    master.put_back(moment)
    for signal, value in again.changes:
        _set(made, master, signal, value)
    _Keep(made, master, recorder, moment.time)()


def ticks(made: RunPlan, master: Master, recorder: Recorder) -> Iterator[Tick]:
    """The ticks that are left, with a checkpoint before those at which one is due."""
    again, every = made.request.resume, made.request.checkpoint_interval
    start = again.checkpoint.moment.time if again else 0
    due = (start // every + 1) * every if every else made.request.stop
    for time, order in master.ticks(made.request.stop, recorder):
        if time < start:
            continue
        if time < due or _cut(made, time):
            yield time, order
        else:
            due = (time // every + 1) * every
            yield time, order.framed([_Keep(made, master, recorder, time)])


def _cut(made: RunPlan, time: int) -> bool:
    """Whether a step under way just before `time` [ns] was cut to end with the run, which then cannot end later."""
    periods = [made.nodes[name].period for name in made.schedule.parallel]
    return any((time - 1) // period * period + period > made.request.stop for period in periods)


@dataclass(frozen=True, slots=True)
class _Keep:
    """Writes a checkpoint of the run as it is before the tick at `time` [ns]."""

    made: RunPlan
    master: Master
    recorder: Recorder
    time: int

    def __call__(self) -> None:
        models = {name: model.sha256 for name, model in self.made.provenance.models.items()}
        self.recorder.flush()
        made, moment = self.made, self.master.moment(self.time)
        kept = Checkpoint(moment, self.recorder.rows, asked(made.request), models, digest(made))
        write_checkpoint(kept, self.made.request.folder)


def check_same(made: RunPlan) -> None:
    """Raises CosimError when the FMUs are not those of the checkpoint, or when the run would end before it."""
    again = made.request.resume
    if again is None:
        return
    time = again.checkpoint.moment.time
    if made.request.stop <= time:
        raise CosimError(f"the checkpoint is of {to_seconds(time):g} s; let the run end later")
    for event, signal, _ in made.request.events[len(again.checkpoint.asked["events"]) :]:
        if event * SECOND < time:
            raise CosimError(f"{signal} cannot be set at {event:g} s: the checkpoint is of {to_seconds(time):g} s")
    for signal, _ in again.changes:
        _free(made, signal)
    if again.checkpoint.digest != digest(made):
        raise CosimError("the checkpoint is of a system with other instances, values or connections; begin anew")
    for name, model in made.provenance.models.items():
        if again.checkpoint.models.get(name) != model.sha256:
            raise CosimError(f"{model.file} is not the FMU of the checkpoint; begin the run anew")


def digest(made: RunPlan) -> str:
    """Of all that makes the system of a run but for its FMUs and for values that change on the way."""
    told = []
    for node in made.nodes.values():
        values = [(key, Path(v).name if isinstance(v, str) else v) for key, v in sorted(node.values.items())]
        told.append((node.name, node.period, node.kind, values, [*node.incoming.values()], sorted(node.faults.items())))
    return sha256(repr((told, made.schedule.sequential, made.schedule.parallel)).encode()).hexdigest()


def _free(made: RunPlan, signal: str) -> tuple[str, str, Port]:
    """The instance, the variable and its port, if it can be set where a run goes on; raises CosimError."""
    instance, variable = made.configured.configuration.system.split(signal)
    node = made.nodes[instance]
    port = node.face.ports.get(variable)
    fed = variable in node.incoming or variable in node.faults
    if port is None or not ((port.causality == "input" and not fed) or port.variability == "tunable"):
        raise CosimError(
            f"{signal} cannot be set where a run goes on: only inputs that nothing feeds and tunable parameters can"
        )
    return instance, variable, port


def _set(made: RunPlan, master: Master, signal: str, value: Value) -> None:
    instance, variable, port = _free(made, signal)
    master.set(instance, {variable: coerce(signal, port, value)})
