"""What the solvers of MpcAllocator take inside the FMU over the double lane change, as its own outputs tell.

Caches are cold there: between two samples run 20 ms of plant. Runs repeat to the bit, so that the rounds time the same
work; figures to hold against the aims are those of all samples of all rounds.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.spread import Spread, microseconds, spread
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load

ROUNDS = 5
MEAN = {"solver": 1000.0, "allocation": 20.0}
"""Most that a solver may take on average [us]."""
WORST = {"solver": 5000.0}
"""Most that a solver may ever take [us]."""
_TITLES = {"solver": "prediction", "allocation": "force distribution"}


@dataclass(frozen=True, slots=True)
class Inside:
    """Microseconds of one solver, and its iterations on average."""

    time: Spread
    iterations: float


def measure(rounds: int = ROUNDS) -> tuple[dict[str, Inside], float]:
    """By solver what it takes; and mean microseconds of an exchange with the FMU: set inputs, sample, get outputs."""
    times: dict[str, list[np.ndarray]] = {name: [] for name in _TITLES}
    iterations: dict[str, float] = {}
    exchanges = []
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as folder:
            request = Request(load("double-lane-change"), Path(folder), [("mpc.solver.timed", "true")])
            finished = run(request)
            for name, seen in times.items():
                seen.append(1e6 * finished.results.samples("mpc", f"{name}.time"))
                iterations[name] = float(finished.results.samples("mpc", f"{name}.iterations").mean())
        spent = finished.summary.instances["mpc"]
        exchanges.append(1e6 * spent.time / spent.calls)
    return {name: Inside(spread(seen), iterations[name]) for name, seen in times.items()}, float(np.mean(exchanges))


def rows(rounds: int | None) -> Iterator[tuple[str, str, str, str]]:
    """What `python -m benchmarks` prints."""
    rounds = rounds or ROUNDS
    found, exchange = measure(rounds)
    for name, title in _TITLES.items():
        seen = found[name]
        against = f"{microseconds(seen.time, rounds)}; {seen.iterations:.0f} iterations"
        aim = f"<= {MEAN[name]:.0f} us" + (f", worst {WORST[name]:.0f}" if name in WORST else "")
        yield f"double-lane-change, in the FMU: {title}", f"{seen.time.mean:.1f} us", against, aim
    yield "  MpcAllocator: set + 20 ms sample + get", f"{exchange:.0f} us", "mean; both solvers and all around them", ""


if __name__ == "__main__":
    for row in rows(None):
        print("  |  ".join(row))
