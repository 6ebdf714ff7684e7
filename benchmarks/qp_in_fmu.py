"""What the solvers of MpcAllocator take inside the FMU over the double lane change, as its own outputs tell.

Caches are cold there: between two samples run 20 ms of plant. Runs repeat to the bit, so the best of several runs is
taken for each sample, then mean and worst over the samples.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from cosim.run import Request, run
from cosim.scenarios import load
from fmukit.direct import Direct
from fmukit.reference_run import reference_run
from fmus.controllers.mpc_allocator import COMPONENT

ROUNDS = 5
_SAMPLES = 100
_SOLVERS = {"solver": ("prediction", "<= 1000, worst 5000"), "allocation": ("force distribution", "<= 20")}


@dataclass(frozen=True, slots=True)
class Inside:
    """Microseconds of one solver, and its iterations on average."""

    mean: float
    worst: float
    iterations: float


def measure(rounds: int = ROUNDS) -> tuple[dict[str, Inside], float, float]:
    """By solver what it takes; and microseconds of a whole sample: exchange with the FMU, and CasADi's own machine."""
    times: dict[str, list[np.ndarray]] = {name: [] for name in _SOLVERS}
    exchange = np.inf
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as folder:
            request = Request(load("double-lane-change"), Path(folder), [("mpc.solver.timed", "true")])
            summary, results = run(request)[:2]
        samples = results.instants("mpc")
        for name, seen in times.items():
            seen.append(1e6 * results[f"mpc.{name}.time"][samples])
        spent = summary["instances"]["mpc"]
        exchange = min(exchange, 1e6 * spent["time"] / spent["calls"])
    best = {name: np.min(seen, axis=0) for name, seen in times.items()}
    found = {
        name: Inside(best[name].mean(), best[name].max(), results[f"mpc.{name}.iterations"][samples].mean())
        for name in _SOLVERS
    }
    return found, exchange, _interpreted(rounds)


def _interpreted(rounds: int) -> float:
    """Microseconds of a sample of the reference run by CasADi's machine, the solvers compiled all the same."""
    played = reference_run(COMPONENT)
    assert played is not None
    instance, best = Direct(COMPONENT, inputs=played.inputs(0.0)), np.inf
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(_SAMPLES):
            instance.sample()
        best = min(best, (time.perf_counter() - start) / _SAMPLES)
    return 1e6 * best


def rows(rounds: int | None) -> Iterator[tuple[str, str, str, str]]:
    """What `python -m benchmarks` prints."""
    found, exchange, interpreted = measure(rounds or ROUNDS)
    for name, (title, aim) in _SOLVERS.items():
        seen = found[name]
        against = f"us in the FMU, mean; worst {seen.worst:.1f}; {seen.iterations:.0f} iterations"
        yield f"double-lane-change: {title}", f"{seen.mean:.1f}", against, aim
    against = f"CasADi's machine {interpreted:.0f} us / exchange with the FMU {exchange:.0f} us"
    yield "  MpcAllocator interpreted against compiled", f"{interpreted / exchange:.2f}", against, ""


if __name__ == "__main__":
    for row in rows(None):
        print("  |  ".join(row))
