"""The local problems of RecedingHorizonPlanner along its built-in road, compiled beside interpreted in the same run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from fmus.planner.receding import offline
from fmus.planner.receding.search import Tools

ROUNDS = 5
AIM = 0.020
"""Mean [s] of a compiled local problem."""


@dataclass(frozen=True, slots=True)
class Seen:
    """Seconds per local problem, mean and largest, the best of the rounds; iterations on average."""

    mean: float
    largest: float
    iterations: float


def measure(rounds: int = ROUNDS) -> tuple[Seen, Seen]:
    """Compiled and interpreted, their rounds in turns."""
    ways = offline.compiled(), offline.interpreted()
    pairs = [[_round(way) for way in ways] for _ in range(rounds)]
    seen = zip(*pairs, strict=True)
    best = [Seen(*(min(getattr(one, name) for one in some) for name in Seen.__slots__)) for some in seen]
    return best[0], best[1]


def rows(rounds: int | None) -> Iterator[tuple[str, str, str, str]]:
    """For the table of all figures."""
    ours, slow = measure(rounds or ROUNDS)
    against = f"ms mean, {1e3 * ours.largest:.1f} ms largest; {ours.mean / slow.mean:.2f} of interpreted"
    count = f"{ours.iterations:.0f} iterations"
    yield (
        "receding horizon, local problem",
        f"{1e3 * ours.mean:.1f}",
        f"{against}; {count}",
        f"<= {1e3 * AIM:.0f} ms mean",
    )


def _round(way: Tools) -> Seen:
    p = offline.parameters({"solver.timed": True})
    records = offline.drive(way, p).records
    times = [record.time for record in records]
    iterations = sum(record.iterations for record in records) / len(records)
    return Seen(sum(times) / len(times), max(times), iterations)
