"""The steps of an instance through the host's time: which are possible, and what becomes of those that are not."""

from __future__ import annotations

from .access import RefusalError
from .core import Core
from .life import MODES, STEPPING

_LONGEST = 1e9
_FURTHEST = 1e12
_TOLERANCE = 1e-6


class Steps:
    """Takes one instance from step to step. A step may begin a little before the end of the last: hosts round."""

    def __init__(self, core: Core) -> None:
        self._core = core
        self._slack = _TOLERANCE * core.about.step

    def take(self, time: float, size: float) -> bool:
        """A step from `time` over `size` [s]; False when it was discarded and the outputs are those of before."""
        core = self._core
        life, computation = core.life, core.computation
        try:
            if life.mode != STEPPING or life.pending or life.broken or not 0.0 < size <= _LONGEST:
                return self._discard(size)
            earliest = life.time - self._slack if life.anchored else -_FURTHEST
            if computation is None or not earliest <= time <= _FURTHEST:
                return self._discard(size, time)
            code = computation.step(life, time, size)
            if code:
                return self._refuse(
                    f"the step from {time} s failed: {computation.reason(code)}; the last good values are kept"
                )
            if not life.anchored:
                life.origin, life.anchored = time, True
            life.time = time + size
            core.buffer[core.fault] = 0.0
            if core.about.remarks:
                core.advise()
            return True
        except BaseException as error:
            core.refuse(error)
            life.pending = False
            return False

    def _discard(self, size: float, time: float | None = None) -> bool:
        """Discard a step; after a call that was refused before, there is nothing more to say."""
        life = self._core.life
        if life.mode != STEPPING:
            return self._refuse(f"doStep is not allowed in the state '{MODES[life.mode]}'; initialise first")
        if not 0.0 < size <= _LONGEST:
            return self._refuse(f"a step of {size} s is not possible; step forward by 0 < h <= 1e9 s")
        if time is not None and not abs(time) <= _FURTHEST:
            return self._refuse(f"a step from {time} s is not possible; keep the time within +-1e12 s")
        if time is not None:
            return self._refuse(
                f"a step from {time} s is not possible at {life.time} s; restore an FMU state to go back in time"
            )
        life.pending = False
        return False

    def _refuse(self, sentence: str) -> bool:
        """Say why the step is discarded; the one after it is served again."""
        self._core.refuse(RefusalError(sentence))
        self._core.life.pending = False
        return False
