"""What every part of an instance works on: its buffer and texts, its life, its computation and its faults.

A call that cannot be served is logged as one sentence and changes nothing. Unless it only wanted to read, it also sets
the output `fault` and makes the next step return discard. The step after that is served again, unless the instance
could not be initialised at all.
"""

from __future__ import annotations

from array import array
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from pythonfmu.enums import Fmi2Status
from pythonfmu.logmsg import LogMsg

from .access import RefusalError
from .computation import Computation
from .description import Description
from .library import FILE, LibraryError, load
from .life import Life
from .script import ScriptError
from .state import Snapshot
from .table import TableError, read

PLAIN = (RefusalError, TableError, LibraryError, ScriptError)
"""Errors whose message is a sentence for the user."""


class Core:
    """One instance without its FMI callbacks.

    `buffer` has the doubles, at `address` in memory, `strings` the texts by slot; `computation` is None when it could
    not be made. `queue` takes the messages, which PythonFMU hands to the host after the call.
    """

    def __init__(self, about: Description, resources: Path, queue: list[LogMsg]) -> None:
        self.about, self.fault = about, about.fault
        self.buffer = array("d", bytes(8 * about.size))
        self.address = self.buffer.buffer_info()[0]
        self.strings: dict[int, str] = {}
        self.life = Life()
        self.store: Callable[[int, int], int] = _store_nothing
        self.computation: Computation | None = None
        self._resources, self._queue = resources, queue
        self._given: set[int] = set()
        for slot, scalar in enumerate(about.scalars):
            if scalar.type == "String":
                self.strings[slot] = scalar.start
            else:
                self.buffer[slot] = float(scalar.start)

    def attach(self, package: Path) -> None:
        """Load what computes the instance from the folder of its package; what goes wrong breaks the instance."""
        try:
            library = load(package / FILE, self.about.size, self)
            self.store = library.fmukit_store
            self.computation = Computation(self.about, self.buffer, self.strings, library, package)
        except BaseException as error:
            self.break_down(error)

    # computing

    def initialise(self) -> None:
        """Compute derived values, states and outputs from parameters and inputs, when they have changed."""
        computation, life, about = self.computation, self.life, self.about
        if computation is None or life.broken or not life.dirty:
            return
        cells, rows = array("d"), 0
        if about.table:
            cells, rows = read(self.strings[about.table.slot], about.table, self._resources)
        code = computation.initialise(self._seed(), cells, rows)
        if code:
            raise RefusalError(f"initialisation failed: {computation.reason(code)}{computation.remedy(code)}")
        computation.start(self.buffer[about.period_slot], self._seed())
        life.samples, life.dirty = 0, False
        self._given.clear()

    def _seed(self) -> int:
        slot = self.about.seed_slot
        return int(self.buffer[slot]) if slot >= 0 else 0

    def advise(self) -> None:
        """Log what the user should know, each remark when it begins to apply; nothing is refused."""
        for remark in () if self.life.broken else self.about.remarks:
            text = remark.made(self.buffer)
            if text and remark.slot not in self._given:
                self.warn(text)
            (self._given.add if text else self._given.discard)(remark.slot)

    # faults

    def refuse(self, error: BaseException) -> None:
        """Log the sentence, raise `fault`, discard the next step."""
        self.life.pending = True
        self.buffer[self.fault] = 1.0
        self.complain(error)

    def complain(self, error: BaseException) -> None:
        """Log the sentence of a call that changes nothing when it is refused."""
        plain = isinstance(error, PLAIN)
        self.warn(str(error) if plain else f"unexpected {type(error).__name__}: {error}; the call is ignored")

    def break_down(self, error: BaseException) -> None:
        """As `refuse`, for good: the instance has no valid state, every step is discarded until a reset."""
        self.refuse(error)
        self.life.broken = True

    def warn(self, text: str) -> None:
        """Log a sentence. Hosts use messages as printf formats: `%` is doubled."""
        clean = text.encode("utf-8", "replace").decode("utf-8").replace("%", "%%").replace("\0", "?")
        self._queue.append(LogMsg(Fmi2Status.warning, "logStatusWarning", clean))

    # state

    def snapshot(self) -> Snapshot:
        """A copy of all the instance is."""
        return Snapshot(self.buffer.tobytes(), tuple(self.strings.items()), replace(self.life))

    def restore(self, snapshot: Snapshot) -> None:
        """Be as the snapshot says; raises RefusalError when there is nothing to compute with."""
        if self.computation is None:
            raise RefusalError("an FMU state is of no use to an instance that could not be made; see its first message")
        self.buffer[:] = array("d", snapshot.buffer)
        self.strings.update(snapshot.strings)
        self.life = replace(snapshot.life)
        self.computation.start(self.buffer[self.about.period_slot], self._seed())


def _store_nothing(_buffer: int, _transfer: int) -> int:
    """For an instance without its library, which discards every step anyway."""
    return 0
