"""Getting and setting variables, checked and all or nothing; lists the host repeats are worked out once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from .access import Access, RefusalError, access_to, check_settable, complaint
from .core import PLAIN, Core
from .life import INITIALISING, STEPPING, TERMINATED

_FROM_DOUBLE: dict[str, Callable[[float], Any]] = {"Real": float, "Integer": int, "Boolean": bool}


class Values:
    """Access to the variables of an instance by lists of value references; raises what the caller has to refuse.

    The last lists of Real variables are remembered where nothing has to be checked or computed for them: for getting
    outside the initialisation, for setting while stepping. `forget` them when the mode changes.
    """

    _getting: Access
    _setting: Access

    def __init__(self, core: Core) -> None:
        self._core = core
        self._buffer = core.buffer
        self.forget()

    def forget(self) -> None:
        """Look at the next lists anew."""
        self._get_vrs: list[int] | None = None
        self._set_vrs: list[int] | None = None

    def reals(self, vrs: list[int]) -> list[float]:
        """The values of Real variables. A slice is taken here, as a further call would be felt in every exchange."""
        access = self._getting if vrs == self._get_vrs else self._gettable(vrs, "Real")
        where = access.where
        return access.read(self._buffer) if where is None else self._buffer[where].tolist()

    def set_reals(self, vrs: list[int], values: list[float]) -> None:
        """Store the values of Real variables, or none when one may not be set or is outside its limits."""
        self._store(self._setting if vrs == self._set_vrs else self._settable(vrs, "Real"), values)

    def get(self, vrs: list[int], type_: str) -> list[Any]:
        """The values of variables of any type."""
        access = self._gettable(vrs, type_)
        if type_ == "String":
            return [self._core.strings[slot] for slot in access.slots]
        return list(map(_FROM_DOUBLE[type_], access.read(self._buffer)))

    def set(self, vrs: list[int], type_: str, values: list[Any]) -> None:
        """Store the values of variables of any type, all or none; texts are read at initialisation."""
        access = self._settable(vrs, type_)
        if type_ != "String":
            self._store(access, [float(bool(value) if type_ == "Boolean" else value) for value in values])
        elif all(isinstance(value, str) for value in values):
            self._core.strings.update(zip(access.slots, values, strict=True))
        else:
            raise RefusalError("a null pointer is not a text and cannot be set; the old texts are kept")

    def _gettable(self, vrs: list[int], type_: str) -> Access:
        access = access_to(self._core.about, vrs, type_)
        if self._core.life.mode == INITIALISING:
            self._preview()
        elif type_ == "Real":
            self._get_vrs, self._getting = list(vrs), access
        return access

    def _preview(self) -> None:
        """Outputs read during initialisation belong to the parameters and inputs set so far."""
        try:
            self._core.initialise()
        except PLAIN as error:
            self._core.warn(str(error))

    def _settable(self, vrs: list[int], type_: str) -> Access:
        life, about = self._core.life, self._core.about
        access = access_to(about, vrs, type_)
        if life.mode == TERMINATED:
            raise RefusalError("nothing can be set after terminate; reset the instance first")
        check_settable(about, access.slots, life.mode == STEPPING)
        if life.mode != STEPPING:
            life.dirty = True
        elif type_ == "Real":
            self._set_vrs, self._setting = list(vrs), access
        return access

    def _store(self, access: Access, values: list[float]) -> None:
        core = self._core
        misfit = access.store(core.store, core.address, values)
        if misfit:
            raise RefusalError(complaint(core.about.scalars[access.slots[misfit - 1]], values[misfit - 1]))
