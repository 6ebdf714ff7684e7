"""summary.json: what ran, how it ended, what it cost and what came out."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from cosim.engine.outcome import Outcome, Status
from cosim.engine.pace import Pace
from cosim.model.clock import SECOND, to_seconds
from cosim.model.node import Node
from cosim.results.provenance import Provenance, command_line
from cosim.scenario.limit import Verdict
from cosim.scenario.metric import Metric
from fmukit import files

SUMMARY = "summary.json"


@dataclass(frozen=True, slots=True)
class InstanceSummary:
    """What one instance did: its `model`, its communication `period` [s], `calls` of its steps and their `time` [s]."""

    model: str
    period: float
    calls: int
    time: float


@dataclass(frozen=True, slots=True)
class PaceSummary:
    """How a run kept the time of the wall.

    It was to make `factor` simulated seconds per second; `overruns` of its `ticks` began more than 1 ms late, the worst
    by `latest` [s].
    """

    factor: float
    ticks: int
    overruns: int
    latest: float


@dataclass(frozen=True, slots=True)
class Summary:
    """The content of summary.json; its keys are the names of these fields, and `units` of the metrics beside them.

    scenario          name of the scenario
    status            "ok"; "missed" where a limit of the scenario was not kept; "failed"; "interrupted"
    reason            one sentence; empty when the status is "ok", unless an FMU ended the simulation itself
    stop_time         simulated time reached [s]
    wall_time         real time it took [s], without loading and initialising
    real_time_factor  simulated time, of a resumed run since then, per wall_time
    record_every      time between two recorded rows [s], 0 for a row at every tick
    unrecorded        patterns of the signals that were left out of the results
    seed              seed of all noise
    command           the command line of the process
    pace              how a run with --realtime kept its time, null without: see `PaceSummary`
    provenance        what the run was made of, see `cosim.results.provenance.Provenance`
    instances         what each instance did, by its name
    limits            what the scenario wants of its metrics, by what is wrong where it is not kept: `metric`, `value`,
                      `most`, `least`, and whether it was `kept` (null where the value is not known)
    metrics           figures of the run by name; in the file the values stand under `metrics` (counts as integers,
                      decisions as words, null for NaN) and their units under `units`
    """

    scenario: str
    status: Status
    reason: str
    stop_time: float
    wall_time: float
    real_time_factor: float
    record_every: float
    unrecorded: tuple[str, ...]
    seed: int
    command: str
    provenance: Provenance
    instances: Mapping[str, InstanceSummary]
    metrics: Mapping[str, Metric] = field(default_factory=dict)
    limits: Sequence[Verdict] = ()
    pace: PaceSummary | None = None

    def data(self) -> dict[str, Any]:
        """The summary as JSON has it: plain values only, metrics apart from their units."""
        plain = asdict(self) | {"unrecorded": list(self.unrecorded)}
        plain["provenance"] = self.provenance.data()
        plain["limits"] = {verdict.limit.words: _plain(verdict) for verdict in self.limits}
        plain["metrics"] = {name: metric.plain for name, metric in self.metrics.items()}
        return plain | {"units": {name: metric.unit for name, metric in self.metrics.items()}}

    def json(self) -> str:
        """The summary as indented JSON text without NaN."""
        return json.dumps(self.data(), indent=2, allow_nan=False)


def summarise(
    scenario: str,
    seed: int,
    outcome: Outcome,
    nodes: Mapping[str, Node],
    provenance: Provenance,
    metrics: Mapping[str, Metric],
    limits: Sequence[Verdict] = (),
    record_every: int = 0,
    unrecorded: Sequence[str] = (),
    pace: Pace | None = None,
) -> Summary:
    """The summary of a run that ended with `outcome`; `record_every` [ns]."""
    wall, reached = outcome.wall / SECOND, to_seconds(outcome.time)
    return Summary(
        scenario=scenario,
        status=outcome.status,
        reason=outcome.reason,
        stop_time=reached,
        wall_time=wall,
        real_time_factor=(reached - to_seconds(outcome.begun)) / wall if wall else 0.0,
        record_every=to_seconds(record_every),
        unrecorded=tuple(unrecorded),
        seed=seed,
        command=command_line(),
        provenance=provenance,
        instances={name: _instance(name, node, outcome) for name, node in nodes.items()},
        metrics=metrics,
        limits=tuple(limits),
        pace=None if pace is None else PaceSummary(pace.factor, pace.ticks, pace.overruns, pace.latest),
    )


def write_summary(summary: Summary, folder: Path) -> None:
    """Write `folder`/summary.json, which then is whole: on OSError no file is left."""
    files.write(folder / SUMMARY, f"{summary.json()}\n".encode())


def _instance(name: str, node: Node, outcome: Outcome) -> InstanceSummary:
    return InstanceSummary(
        model=node.face.model,
        period=to_seconds(node.period),
        calls=outcome.calls.get(name, 0),
        time=outcome.times.get(name, 0) / SECOND,
    )


def _plain(verdict: Verdict) -> dict[str, Any]:
    limit = verdict.limit
    bounds = {"value": verdict.value, "most": limit.most, "least": limit.least}
    return {"metric": limit.metric, **{name: _finite(value) for name, value in bounds.items()}, "kept": verdict.kept}


def _finite(value: float) -> float | None:
    """JSON has no NaN: a metric that cannot be computed is null."""
    return float(value) if math.isfinite(value) else None
