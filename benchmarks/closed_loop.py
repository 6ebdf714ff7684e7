"""The whole loop of high-speed-tracking through its FMUs, recorder on: real-time factor and who takes the time."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from cosim.results.summary import InstanceSummary, Summary
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load

ROUNDS = 7


@dataclass(frozen=True, slots=True)
class ClosedLoop:
    """Medians over the runs: `share` of the wall time per instance, and of the master for all the rest."""

    real_time_factor: float
    microseconds_per_call: dict[str, float]
    share: dict[str, float]


def measure(name: str = "high-speed-tracking", rounds: int = ROUNDS, stop_time: float | None = None) -> ClosedLoop:
    """Run the scenario `rounds` times after one to warm up, in this process; results go to a scratch folder."""
    scenario = load(name)
    with tempfile.TemporaryDirectory() as folder:
        requests = [Request(scenario, Path(folder) / str(i), stop_time=stop_time) for i in range(rounds + 1)]
        summaries = [run(request).summary for request in requests][1:]
    instances = summaries[0].instances
    share = {name: median(_share(s, name) for s in summaries) for name in instances}
    return ClosedLoop(
        real_time_factor=median(s.real_time_factor for s in summaries),
        microseconds_per_call={n: median(_microseconds(s.instances[n]) for s in summaries) for n in instances},
        share=share | {"master": median(1.0 - sum(_share(s, n) for n in instances) for s in summaries)},
    )


def _share(summary: Summary, name: str) -> float:
    return summary.instances[name].time / summary.wall_time


def _microseconds(instance: InstanceSummary) -> float:
    return instance.time / instance.calls * 1e6
