"""Integer time: seconds come in once, as whole nanoseconds, and everything else is integer arithmetic."""

from __future__ import annotations

import math
from collections.abc import Iterable

from cosim.errors import CosimError

SECOND = 1_000_000_000
LONGEST = 1e9
"""The longest time [s]: beyond, doubles do not even tell tenths of a microsecond apart."""
_ROUNDING = 1e-6  # [ns] decimal seconds such as 0.1 + 0.2 miss the whole nanosecond by this much at most


def nanoseconds(seconds: float, owner: str) -> int:
    """The whole number of nanoseconds in a positive `seconds`; the error names `owner`."""
    exact = seconds * SECOND
    if not (math.isfinite(exact) and seconds > 0.0):
        raise CosimError(f"{owner} is {seconds:g} s; it must be positive and finite")
    if seconds > LONGEST:
        raise CosimError(f"{owner} is {seconds:g} s; it must be at most {LONGEST:g} s")
    whole = round(exact)
    if whole == 0 or abs(exact - whole) > max(_ROUNDING, 1e-15 * exact):
        raise CosimError(f"{owner} is {seconds!r} s, which is not a whole number of nanoseconds; take {_near(exact)} s")
    return whole


def _near(exact: float) -> str:
    """The nearest duration of at least one nanosecond, in seconds."""
    return f"{max(round(exact), 1) / SECOND:.9f}".rstrip("0")


def base_tick(periods: Iterable[int]) -> int:
    """The longest tick [ns] that divides every period."""
    return math.gcd(*periods)


def hyperperiod(periods: Iterable[int]) -> int:
    """The time [ns] after which the pattern of due instances repeats."""
    return math.lcm(*periods)


def to_seconds(time: int) -> float:
    """The double nearest to `time` [ns] in seconds: one division, so it carries no accumulated error."""
    return time / SECOND
