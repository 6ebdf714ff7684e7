"""What every part of an instance works on: its buffer, its mode, its kernel and its faults.

A call that cannot be served is logged as one sentence, changes nothing, sets the output `fault`, and makes the next
step return discard. The step after that is served again, unless the instance could not be initialised at all.
"""

from __future__ import annotations

import sys
import weakref
from array import array
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

from pythonfmu import Fmi2Slave
from pythonfmu.enums import Fmi2Status

from . import library, script, table
from .description import Description
from .leaving import release_interpreter_once
from .ports import Plan, RefusalError
from .stepping import TOO_LONG, Continuous, Sampled

INSTANTIATED, INITIALISING, STEPPING, TERMINATED = range(4)
_TOLERANCE = 1e-6
PLAIN = (RefusalError, table.TableError, library.LibraryError, script.ScriptError)


class Instance(Fmi2Slave):
    """The class made for an FMU carries its description and the name of its package."""

    description_: ClassVar[Description]
    package: ClassVar[str]
    _get_plan: Plan
    _set_plan: Plan

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
        self._fault, self._slack = self.description_.fault, _TOLERANCE * self.description_.step
        self._store: Callable[[int, int], int] = _store_nothing
        self._resources = Path(str(kwargs.get("resources")))
        self._script: script.Script | None = None
        self._get_vrs: list[int] | None = None
        self._set_vrs: list[int] | None = None
        self._fill_start_values()
        if "logger" in kwargs:
            resources = self._resources
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
            self._store = self._library.fmukit_store
            weakref.finalize(self, library.release, path).atexit = False
            if self.description_.program:
                self._script = script.Script(self.description_, self._buffer, self._strings, path.parent)
                weakref.finalize(self, script.release, path.parent).atexit = False
            self._motion = self._moved()
        except BaseException as error:
            self._break(error)

    def _moved(self) -> Continuous | Sampled:
        """What takes the instance through time."""
        about = self.description_
        if about.continuous:
            return Continuous(self._library, self._address, about.max_substep)
        sample = self._script.sample if self._script else self._library.fmukit_sample
        return Sampled(sample, self._address, 8 * about.size)

    def _enter(self, mode: int) -> None:
        self._mode, self._get_vrs, self._set_vrs = mode, None, None

    def _initialise(self) -> None:
        """Compute derived values, states and outputs from parameters and inputs, when they have changed."""
        if self._broken or not self._dirty:
            return
        about, buffer = self.description_, self._buffer
        seed = int(buffer[about.seed_slot]) if about.seed_slot >= 0 else 0
        code = self._computed(seed)
        if code:
            advice = "" if code == script.SAID else "; check the parameters"
            raise RefusalError(f"initialisation failed: {self._reason(code)}{advice}")
        self._motion.start(buffer[about.period_slot], seed)
        self._dirty = False

    def _advise(self) -> None:
        """Log what the user should know of the chosen parameters; nothing is refused."""
        for advice in () if self._broken else self.description_.advice:
            text = advice.given(self._buffer)
            if text:
                self._tell(text, Fmi2Status.warning)

    def _computed(self, seed: int) -> int:
        about, flat, rows = self.description_, array("d"), 0
        if about.table:
            flat, rows = table.read(self._strings[about.table.slot], about.table, self._resources)
        if self._script:
            return self._script.initialise(flat, rows)
        code: int = self._library.fmukit_initialise(self._address, seed, flat.buffer_info()[0], float(rows))
        return code

    def _reason(self, code: int) -> str:
        ports = self.description_.ports
        if code == TOO_LONG:
            return "it needs more than ten million substeps or samples"
        if code < 0:
            return self._script.said if self._script else "the kernel reported an error"
        return f"{ports[code - 1].name if code <= len(ports) else 'an internal state'} is not a finite number"

    def _refuse(self, error: BaseException) -> None:
        """Log the sentence, raise `fault`, discard the next step."""
        self._pending = True
        self._buffer[self._fault] = 1.0
        plain = isinstance(error, PLAIN)
        text = str(error) if plain else f"unexpected {type(error).__name__}: {error}; the call is ignored"
        self._tell(text, Fmi2Status.warning)

    def _break(self, error: BaseException) -> None:
        """As `_refuse`, for good: the instance has no valid state, every step is discarded until a reset."""
        self._refuse(error)
        self._broken = True

    def _tell(self, text: str, status: Fmi2Status) -> None:
        """Hosts use messages as printf formats: `%` is doubled."""
        self.log(text.encode("utf-8", "replace").decode("utf-8").replace("%", "%%").replace("\0", "?"), status)


def _store_nothing(_buffer: int, _transfer: int) -> int:
    """For an instance without its library, which discards every step anyway."""
    return 0


def _leave_path(resources: str) -> None:
    """Remove the entry PythonFMU puts on the module path for every instance and never takes away."""
    if resources in sys.path:
        sys.path.remove(resources)
