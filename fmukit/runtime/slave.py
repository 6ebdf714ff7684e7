"""The FMI callbacks of one instance: life cycle, get and set, step, state.

Nothing ever raises across the FMI boundary: PythonFMU would turn it into a fatal error and damage its reference
counts. A call that cannot be served is logged as one sentence, changes nothing, sets the output `fault`, and makes the
next step return discard. The step after that is served again, unless the instance could not be initialised at all.
"""

from __future__ import annotations

import sys
import weakref
from array import array
from pathlib import Path
from typing import Any, ClassVar

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from . import library, state, table
from .description import Description
from .leaving import release_interpreter_once
from .ports import Plan, RefusalError, check_settable, complaint, plan
from .stepping import TOO_LONG, Continuous, Sampled

INSTANTIATED, INITIALISING, STEPPING, TERMINATED = range(4)
_MODES = ("instantiated", "initialisation", "stepping", "terminated")
_PLAIN = (RefusalError, table.TableError, library.LibraryError)
_LONGEST_STEP = 1e9
_FURTHEST_TIME = 1e12
_TOLERANCE = 1e-6


class Slave(Fmi2Slave):
    """One instance; the class made for an FMU carries its description and the name of its package."""

    description_: ClassVar[Description]
    package: ClassVar[str]

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        self._buffer = array("d", bytes(8 * self.description_.size))
        self._address = self._buffer.buffer_info()[0]
        self._mode = INSTANTIATED
        self._dirty = True
        self._pending = False
        self._broken = False
        self._anchored = False
        self._origin = self._time = 0.0
        self._get_vrs: list[int] | None = None
        self._set_vrs: list[int] | None = None
        self._fill_start_values()
        if "logger" in kwargs:
            resources = Path(str(kwargs.get("resources")))
            _leave_path(str(kwargs.get("resources")))
            self._attach(resources / self.package / library.FILE)
            release_interpreter_once(resources.parent / "binaries" / "linux64" / f"{self.description_.name}.so")

    def _fill_start_values(self) -> None:
        self._strings: dict[int, str] = {}
        for slot, port in enumerate(self.description_.ports):
            if port.type == "String":
                self._strings[slot] = port.start
            else:
                self._buffer[slot] = float(port.start)

    def _attach(self, path: Path) -> None:
        try:
            self._library = library.load(path, self.description_.size)
            weakref.finalize(self, library.release, path).atexit = False
            self._motion = (
                Continuous(self._library, self._address, self.description_.max_substep)
                if self.description_.continuous
                else Sampled(self._library, self._address)
            )
        except BaseException as error:
            self._break(error)

    # life cycle

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        self._expect("setupExperiment", INSTANTIATED)

    def enter_initialization_mode(self) -> None:
        if self._expect("enterInitializationMode", INSTANTIATED):
            self._enter(INITIALISING)

    def exit_initialization_mode(self) -> None:
        if not self._expect("exitInitializationMode", INITIALISING):
            return
        self._enter(STEPPING)
        try:
            self._initialise()
        except BaseException as error:
            self._break(error)

    def terminate(self) -> None:
        if self._expect("terminate", STEPPING):
            self._enter(TERMINATED)

    def _expect(self, call: str, mode: int) -> bool:
        if self._mode != mode:
            self._refuse(
                RefusalError(f"{call} is not allowed in the state '{_MODES[self._mode]}'; the call is ignored")
            )
        return self._mode == mode

    def _enter(self, mode: int) -> None:
        self._mode, self._get_vrs, self._set_vrs = mode, None, None

    def _initialise(self) -> None:
        """Compute derived values, states and outputs from parameters and inputs, when they have changed."""
        if self._broken or not self._dirty:
            return
        about, buffer = self.description_, self._buffer
        seed = int(buffer[about.seed_slot]) if about.seed_slot >= 0 else 0
        flat, rows = table.read(self._strings[about.table.slot], about.table) if about.table else (array("d"), 0)
        code = self._library.fmukit_initialise(self._address, seed, flat.buffer_info()[0], float(rows))
        if code:
            raise RefusalError(f"initialisation failed: {self._reason(code)}; check the parameters")
        self._motion.start(buffer[about.period_slot], seed)
        self._dirty = False

    # time

    def do_step(self, current_time: float, step_size: float) -> bool:
        try:
            if self._mode != STEPPING or self._pending or self._broken or not 0.0 < step_size <= _LONGEST_STEP:
                return self._discard(step_size)
            if not self._anchored:
                self._origin = self._time = current_time
                self._anchored = True
            if not self._time - _TOLERANCE * self.description_.step <= current_time <= _FURTHEST_TIME:
                return self._discard(step_size, current_time)
            code = self._motion.step(current_time, step_size, self._origin)
            if code:
                return self._fail(code, current_time)
            self._time = current_time + step_size
            self._buffer[self.description_.fault] = 0.0
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

    def _reason(self, code: int) -> str:
        ports = self.description_.ports
        if code == TOO_LONG:
            return "it needs more than ten million substeps or samples"
        if code < 0:
            return "the kernel reported an error"
        return f"{ports[code - 1].name if code <= len(ports) else 'an internal state'} is not a finite number"

    # values

    def get_real(self, vrs: list[int]) -> list[float]:
        try:
            if vrs == self._get_vrs:
                return self._get_plan.read(self._buffer)
            return self._gettable(vrs, "Real").read(self._buffer)
        except BaseException as error:
            self._refuse(error)
            return [float("nan")] * len(vrs)

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        try:
            self._write(self._set_plan if vrs == self._set_vrs else self._settable(vrs, "Real"), values)
        except BaseException as error:
            self._refuse(error)

    def get_integer(self, vrs: list[int]) -> list[int]:
        try:
            return [int(value) for value in self._gettable(vrs, "Integer").read(self._buffer)]
        except BaseException as error:
            self._refuse(error)
            return [0] * len(vrs)

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        try:
            self._write(self._settable(vrs, "Integer"), [float(value) for value in values])
        except BaseException as error:
            self._refuse(error)

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        try:
            return [value != 0.0 for value in self._gettable(vrs, "Boolean").read(self._buffer)]
        except BaseException as error:
            self._refuse(error)
            return [False] * len(vrs)

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        try:
            self._write(self._settable(vrs, "Boolean"), [1.0 if value else 0.0 for value in values])
        except BaseException as error:
            self._refuse(error)

    def get_string(self, vrs: list[int]) -> list[str]:
        try:
            return [self._strings[slot] for slot in self._gettable(vrs, "String").slots]
        except BaseException as error:
            self._refuse(error)
            return [""] * len(vrs)

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        try:
            slots = self._settable(vrs, "String").slots
            self._strings.update(zip(slots, map(str, values), strict=True))
        except BaseException as error:
            self._refuse(error)

    def _gettable(self, vrs: list[int], type_: str) -> Plan:
        made = plan(self.description_, vrs, type_)
        if self._mode == INITIALISING:
            self._preview()
        elif type_ == "Real":
            self._get_vrs, self._get_plan = list(vrs), made
        return made

    def _preview(self) -> None:
        """Outputs read during initialisation belong to the parameters and inputs set so far."""
        try:
            self._initialise()
        except _PLAIN as error:
            self._tell(str(error), Fmi2Status.warning)

    def _settable(self, vrs: list[int], type_: str) -> Plan:
        made = plan(self.description_, vrs, type_)
        if self._mode == TERMINATED:
            raise RefusalError("nothing can be set after terminate; reset the instance first")
        check_settable(self.description_, made.slots, self._mode == STEPPING)
        if self._mode != STEPPING:
            self._dirty = True
        elif type_ == "Real":
            self._set_vrs, self._set_plan = list(vrs), made
        return made

    def _write(self, where: Plan, values: list[float]) -> None:
        """Store all values of one call, or none when one of them is outside its limits."""
        if not where.accepts(values):
            for slot, value in zip(where.slots, values, strict=True):
                port = self.description_.ports[slot]
                if not port.low <= value <= port.high:
                    raise RefusalError(complaint(port, value))
        where.write(self._buffer, values)

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
            self._restore(snapshot)
        except BaseException as error:
            self._refuse(error)

    def _restore(self, snapshot: state.Snapshot) -> None:
        about, buffer = self.description_, self._buffer
        buffer[:] = array("d", snapshot.buffer)
        self._strings = dict(snapshot.strings)
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

    # faults

    def _refuse(self, error: BaseException) -> None:
        """Log the sentence, raise `fault`, discard the next step."""
        self._pending = True
        self._buffer[self.description_.fault] = 1.0
        plain = isinstance(error, _PLAIN)
        text = str(error) if plain else f"unexpected {type(error).__name__}: {error}; the call is ignored"
        self._tell(text, Fmi2Status.warning)

    def _break(self, error: BaseException) -> None:
        """As `_refuse`, for good: the instance has no valid state, every step is discarded until a reset."""
        self._refuse(error)
        self._broken = True

    def _tell(self, text: str, status: Fmi2Status) -> None:
        """Hosts use messages as printf formats: `%` is doubled."""
        self.log(text.encode("utf-8", "replace").decode("utf-8").replace("%", "%%").replace("\0", "?"), status)


def _leave_path(resources: str) -> None:
    """Remove the entry PythonFMU puts on the module path for every instance and never takes away."""
    if resources in sys.path:
        sys.path.remove(resources)
