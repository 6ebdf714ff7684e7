"""Which slots a list of value references means, worked out once and reused while the host repeats the list."""

from __future__ import annotations

import ctypes
from array import array
from collections.abc import Callable, Sequence
from math import isfinite
from operator import itemgetter
from struct import Struct

from .description import Description, Scalar


class RefusalError(Exception):
    """A call cannot be served; the message is a sentence naming the variable, the value and the remedy."""


class _Transfer(ctypes.Structure):
    """The library's `transfer`: addresses of values, limits and slots."""

    _fields_ = (*((name, ctypes.c_void_p) for name in ("values", "low", "high", "slots")), ("count", ctypes.c_int64))


class Access:
    """The way to the slots of one list of value references, all of one type.

    `where` is the slice of the buffer they lie in, None when they do not lie side by side.
    """

    __slots__ = ("_description", "_kept", "_pack", "_pick", "_transfer", "_values", "slots", "where")

    _pack: Callable[..., None]
    _values: array[float]
    _kept: tuple[object, ...]

    def __init__(self, description: Description, slots: list[int]) -> None:
        count = len(slots)
        self.slots = slots
        contiguous = bool(slots) and slots == list(range(slots[0], slots[0] + count))
        self.where = slice(slots[0], slots[0] + count) if contiguous else None
        self._pick = itemgetter(*slots) if count > 1 else None
        self._description, self._transfer = description, 0

    def read(self, buffer: array[float]) -> list[float]:
        """The values of the slots, in the order asked for."""
        if self.where is not None:
            return buffer[self.where].tolist()
        return list(self._pick(buffer)) if self._pick else []

    def store(self, store: Callable[[int, int], int], buffer: int, values: Sequence[float]) -> int:
        """Put one value into each slot, or none: position from 1 of the first outside its limits, 0 if all fit.

        `store` is the library's, `buffer` the address of the instance's.
        """
        transfer = self._transfer or self._prepare()
        self._pack(self._values, 0, *values)
        return store(buffer, transfer)

    def _prepare(self) -> int:
        """Lay out what the library is given; most lists are for getting only and never need it."""
        scalars, count = [self._description.scalars[slot] for slot in self.slots], len(self.slots)
        self._pack, self._values = Struct(f"{count}d").pack_into, array("d", bytes(8 * count))
        limits = (array("d", [scalar.low for scalar in scalars]), array("d", [scalar.high for scalar in scalars]))
        memory = (self._values, *limits, array("q", self.slots))
        transfer = _Transfer(*(part.buffer_info()[0] for part in memory), count)
        self._kept, self._transfer = (*memory, transfer), ctypes.addressof(transfer)
        return self._transfer


def access_to(description: Description, vrs: Sequence[int], type_: str) -> Access:
    """The way to the variables `vrs`; raises RefusalError when one does not exist or has another type."""
    for vr in vrs:
        if not 0 <= vr < len(description.scalars):
            raise RefusalError(f"there is no variable with value reference {vr}; see modelDescription.xml")
        scalar = description.scalars[vr]
        if scalar.type != type_:
            raise RefusalError(
                f"{scalar.name} is of type {scalar.type}; get and set it as {scalar.type}, not as {type_}"
            )
    return Access(description, list(vrs))


def check_settable(description: Description, slots: list[int], initialised: bool) -> None:
    """Raise RefusalError for outputs, and for parameters once the instance is initialised."""
    for slot in slots:
        scalar = description.scalars[slot]
        if scalar.causality == "output":
            raise RefusalError(f"{scalar.name} is an output and cannot be set; set inputs and parameters only")
        if scalar.causality == "parameter" and initialised:
            raise RefusalError(f"{scalar.name} is a fixed parameter; set it before the end of initialisation, or reset")


def complaint(scalar: Scalar, value: float) -> str:
    """The sentence for a value outside the limits of its variable."""
    unit = "" if scalar.unit == "1" else f" {scalar.unit}"
    limits = f"[{scalar.low:g}, {scalar.high:g}]{unit}"
    if not isfinite(value):
        return f"{scalar.name} = {value} is not a finite number; keep it inside {limits}"
    return f"{scalar.name} = {value!r}{unit} is outside {limits}; the old value is kept"
