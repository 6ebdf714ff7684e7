"""How time passes: a continuous kernel integrates the step it is given, a sampled one serves its own grid.

A step of more than `most` substeps or samples is refused: a host that takes a step of a day by mistake is told at once.

Both `step` functions return the kernel's code: 0, or what went wrong (see `fmukit/packaging/shim.c`), or `TOO_LONG`.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from math import ceil

from .life import Life

TOO_LONG = -2
_TOLERANCE = 1e-6


class Continuous:
    """Integrate in equal substeps no longer than `max_substep` [s], `most` of them in a step."""

    def __init__(self, library: ctypes.PyDLL, address: int, max_substep: float, most: int) -> None:
        self._advance = library.fmukit_advance
        self._address = address
        self._max_substep, self._most = max_substep, most
        self._duration, self._count = max_substep, 1

    def start(self, period: float, seed: int) -> None:
        """Nothing to set: a continuous kernel has neither grid nor noise."""

    def step(self, life: Life, t: float, dt: float) -> int:
        """Integrate from `t` over `dt` [s]."""
        if dt != self._duration:
            self._duration, self._count = dt, substeps(dt, self._max_substep)
        count = self._count
        if count > self._most:
            return TOO_LONG
        code: int = self._advance(self._address, dt / count, count)
        return code


class Sampled:
    """Compute sample k at `origin + k period`, at the start of the step that holds this instant.

    The grid starts with the first step. It is laid on the host's time with a tolerance of 1e-6 period, so neither
    jitter nor the length of the host's steps changes the samples. Instants in a gap of the host's time (it carried on
    after a discarded step) are skipped. A step whose samples cannot all be computed computes none, nor one of more than
    `most` samples.
    """

    def __init__(self, sample: Callable[[int, int, int, float], int], address: int, size: int, most: int) -> None:
        self._sample, self._most = sample, most
        self._address, self._size = address, size
        self._period = 0.0
        self._seed = 0

    def start(self, period: float, seed: int) -> None:
        """Sample every `period` [s], with the noise of `seed`."""
        self._period, self._seed = period, seed

    def step(self, life: Life, t: float, dt: float) -> int:
        """Compute the samples from `t` until before `t` + `dt` [s], and count them in the life."""
        period, origin = self._period, life.origin if life.anchored else t
        index = max(life.samples, ceil((t - origin) / period - _TOLERANCE))
        end = ceil((t + dt - origin) / period - _TOLERANCE)
        if end - index > self._most:
            return TOO_LONG
        code = 0
        if end > index + 1:
            code = self._several(index, end)
        elif end > index:
            code = self._sample(self._address, self._seed, end, index * period)
        if not code:
            life.samples = max(life.samples, end)
        return code

    def _several(self, index: int, end: int) -> int:
        """Compute samples `index` to `end` - 1, or leave the instance as it was."""
        before = ctypes.string_at(self._address, self._size)
        for k in range(index, end):
            code = self._sample(self._address, self._seed, k + 1, k * self._period)
            if code:
                ctypes.memmove(self._address, before, len(before))
                return code
        return 0


def substeps(duration: float, longest: float) -> int:
    """How many equal substeps no longer than `longest` make up `duration`; rounding noise adds none."""
    return max(1, ceil(duration / longest * (1.0 - 1e-9)))
