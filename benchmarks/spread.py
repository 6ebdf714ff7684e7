"""How the times of the same samples, measured in several rounds, are summed up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, slots=True)
class Spread:
    """`mean` and `worst` of all samples of all rounds: what a user gets on this machine, loaded as it is.

    `best_mean` and `best_worst` of the shortest time of each sample in any round: what the program itself takes. They
    leave out whatever does not happen to a sample every time; the distance between both is the load of the machine.
    """

    mean: float
    worst: float
    best_mean: float
    best_worst: float


def spread(rounds: np.ndarray | Sequence[np.ndarray]) -> Spread:
    """Of times (samples,) per round, which do the same work in the same order; ValueError if they are not as many."""
    times = np.asarray(rounds)
    best = times.min(axis=0)
    return Spread(float(times.mean()), float(times.max()), float(best.mean()), float(best.max()))


def microseconds(seen: Spread, rounds: int) -> str:
    """All but the mean, for the table; `seen` in microseconds."""
    best = f"best of {rounds}: mean {seen.best_mean:.1f}, worst {seen.best_worst:.1f}"
    return f"mean; worst {seen.worst:.1f} us; {best}"
