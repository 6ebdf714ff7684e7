"""The FMI callbacks of one instance: life cycle, step and state; `values` has those that get and set.

Nothing ever raises across the FMI boundary: PythonFMU would turn it into a fatal error and damage its reference
counts. See `instance` for what happens instead.
"""

from __future__ import annotations

from array import array
from typing import Any

from . import state
from .instance import INITIALISING, INSTANTIATED, STEPPING, TERMINATED
from .ports import RefusalError
from .values import Values

_MODES = ("instantiated", "initialisation", "stepping", "terminated")
_LONGEST_STEP = 1e9
_FURTHEST_TIME = 1e12


class Slave(Values):
    """One instance of an FMU."""

    # life cycle

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Only checked: time starts where the first step does, and the step is the host's to choose."""
        self._expect("setupExperiment", INSTANTIATED)

    def enter_initialization_mode(self) -> None:
        """From now on outputs read belong to the parameters and inputs set so far."""
        if self._expect("enterInitializationMode", INSTANTIATED):
            self._enter(INITIALISING)

    def exit_initialization_mode(self) -> None:
        """Compute derived values, first states and outputs; what cannot be is told, and every step is discarded."""
        if not self._expect("exitInitializationMode", INITIALISING):
            return
        self._enter(STEPPING)
        try:
            self._initialise()
            self._advise()
        except BaseException as error:
            self._break(error)

    def terminate(self) -> None:
        """Outputs can still be read; nothing can be set."""
        if self._expect("terminate", STEPPING):
            self._enter(TERMINATED)

    def _expect(self, call: str, mode: int) -> bool:
        if self._mode != mode:
            self._refuse(
                RefusalError(f"{call} is not allowed in the state '{_MODES[self._mode]}'; the call is ignored")
            )
        return self._mode == mode

    # time

    def do_step(self, current_time: float, step_size: float) -> bool:
        """One step [s]; False when it was discarded: the outputs stay, `fault` is true and the reason is logged."""
        try:
            if self._mode != STEPPING or self._pending or self._broken or not 0.0 < step_size <= _LONGEST_STEP:
                return self._discard(step_size)
            anchored = self._anchored
            earliest = self._time - self._slack if anchored else -_FURTHEST_TIME
            if not earliest <= current_time <= _FURTHEST_TIME:
                return self._discard(step_size, current_time)
            origin = self._origin if anchored else current_time
            code = self._motion.step(current_time, step_size, origin)
            if code:
                return self._fail(code, current_time)
            self._origin, self._anchored = origin, True
            self._time = current_time + step_size
            self._buffer[self._fault] = 0.0
            return True
        except BaseException as error:
            self._refuse(error)
            self._pending = False
            return False

    def _discard(self, step_size: float, time: float | None = None) -> bool:
        if self._mode != STEPPING:
            self._refuse(RefusalError(f"doStep is not allowed in the state '{_MODES[self._mode]}'; initialise first"))
        elif not 0.0 < step_size <= _LONGEST_STEP:
            self._refuse(RefusalError(f"a step of {step_size} s is not possible; step forward by 0 < h <= 1e9 s"))
        elif time is not None and not abs(time) <= _FURTHEST_TIME:
            self._refuse(RefusalError(f"a step from {time} s is not possible; keep the time within +-1e12 s"))
        elif time is not None:
            text = f"a step from {time} s is not possible at {self._time} s; restore an FMU state to go back in time"
            self._refuse(RefusalError(text))
        self._pending = False
        return False

    def _fail(self, code: int, time: float) -> bool:
        """A step the kernel could not compute: the outputs of the last good one stay."""
        self._refuse(
            RefusalError(f"the step from {time} s failed: {self._reason(code)}; the last good values are kept")
        )
        self._pending = False
        return False

    # state

    def _get_fmu_state(self) -> state.Snapshot:
        return state.Snapshot(
            self._buffer.tobytes(),
            tuple(self._strings.items()),
            self._mode,
            self._dirty,
            self._pending,
            self._broken,
            self._anchored,
            self._motion.index if not self._broken else 0,
            self._origin,
            self._time,
        )

    def _set_fmu_state(self, snapshot: Any) -> None:
        try:
            if not isinstance(snapshot, state.Snapshot) or len(snapshot.buffer) != 8 * self.description_.size:
                reason = snapshot.reason if isinstance(snapshot, state.Refused) else "it is not a state of this FMU"
                raise RefusalError(f"the FMU state is refused: {reason}; the present state is kept")
            if not hasattr(self, "_motion"):
                raise RefusalError(
                    "an FMU state is of no use to an instance that could not be made; see its first message"
                )
            self._restore(snapshot)
        except BaseException as error:
            self._refuse(error)

    def _restore(self, snapshot: state.Snapshot) -> None:
        about, buffer = self.description_, self._buffer
        buffer[:] = array("d", snapshot.buffer)
        self._strings.update(snapshot.strings)
        self._enter(snapshot.mode)
        self._dirty, self._pending, self._broken = snapshot.dirty, snapshot.pending, snapshot.broken
        self._anchored, self._origin, self._time = snapshot.anchored, snapshot.origin, snapshot.time
        seed = int(buffer[about.seed_slot]) if about.seed_slot >= 0 else 0
        self._motion.start(buffer[about.period_slot], seed)
        self._motion.index = snapshot.samples

    @classmethod
    def _fmu_state_to_bytes(cls, snapshot: Any) -> bytes:
        """PythonFMU calls this and the next on the class: there is no instance to raise a fault on."""
        try:
            return state.to_bytes(snapshot, cls.description_)
        except BaseException:
            return b""

    @classmethod
    def _fmu_state_from_bytes(cls, data: bytes) -> state.Snapshot | state.Refused:
        try:
            return state.from_bytes(bytes(data), cls.description_)
        except BaseException as error:
            return state.Refused(f"the bytes cannot be read ({type(error).__name__})")
