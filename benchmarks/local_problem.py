"""The local problems of RecedingHorizonPlanner along its built-in road, compiled beside interpreted in the same run."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from benchmarks.spread import Spread, spread
from fmus.planner.receding import offline
from fmus.planner.receding.search import Tools

ROUNDS = 5
AIM = 0.020
"""Mean [s] of a compiled local problem."""


def measure(rounds: int = ROUNDS) -> tuple[Spread, Spread, float]:
    """Seconds per local problem, compiled and interpreted, their rounds in turns; iterations on average."""
    ways = offline.compiled(), offline.interpreted()
    pairs = [[_round(way) for way in ways] for _ in range(rounds)]
    compiled, interpreted = (spread([times for times, _ in some]) for some in zip(*pairs, strict=True))
    return compiled, interpreted, float(pairs[0][0][1].mean())


def rows(rounds: int | None) -> Iterator[tuple[str, str, str, str]]:
    """For the table of all figures."""
    rounds = rounds or ROUNDS
    ours, slow, iterations = measure(rounds)
    best = f"best of {rounds}: mean {1e3 * ours.best_mean:.1f}, worst {1e3 * ours.best_worst:.1f}"
    against = f"mean; worst {1e3 * ours.worst:.1f} ms; {best}; {iterations:.0f} iterations"
    yield "receding horizon, local problem", f"{1e3 * ours.mean:.1f} ms", against, f"<= {1e3 * AIM:.0f} ms"
    ratio = f"{1e3 * ours.mean:.1f} ms / {1e3 * slow.mean:.1f} ms"
    yield "  compiled against interpreted", f"{ours.mean / slow.mean:.2f}", ratio, "< 1"


def _round(way: Tools) -> tuple[np.ndarray, np.ndarray]:
    """Seconds and iterations of every local problem of a drive."""
    records = offline.drive(way, offline.parameters({"solver.timed": True})).records
    return np.array([record.time for record in records]), np.array([record.iterations for record in records])


if __name__ == "__main__":
    for row in rows(None):
        print("  |  ".join(row))
