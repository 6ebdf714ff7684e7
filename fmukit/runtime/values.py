"""Getting and setting variables, checked and all or nothing; lists the host repeats are worked out once."""

from __future__ import annotations

from pythonfmu.enums import Fmi2Status

from .instance import INITIALISING, PLAIN, STEPPING, TERMINATED, Instance
from .ports import Plan, RefusalError, check_settable, complaint, plan


class Values(Instance):
    """The get and set callbacks of an instance."""

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values at the value references; NaN for all of them when the call is refused."""
        try:
            if vrs == self._get_vrs:
                return self._get_plan.read(self._buffer)
            return self._gettable(vrs, "Real").read(self._buffer)
        except BaseException as error:
            self._refuse(error)
            return [float("nan")] * len(vrs)

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Store all values, or none when one may not be set or is outside its limits."""
        try:
            self._write(self._set_plan if vrs == self._set_vrs else self._settable(vrs, "Real"), values)
        except BaseException as error:
            self._refuse(error)

    def get_integer(self, vrs: list[int]) -> list[int]:
        """As `get_real`; zeros when the call is refused."""
        try:
            return [int(value) for value in self._gettable(vrs, "Integer").read(self._buffer)]
        except BaseException as error:
            self._refuse(error)
            return [0] * len(vrs)

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """As `set_real`."""
        try:
            self._write(self._settable(vrs, "Integer"), [float(value) for value in values])
        except BaseException as error:
            self._refuse(error)

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """As `get_real`; False when the call is refused."""
        try:
            return [value != 0.0 for value in self._gettable(vrs, "Boolean").read(self._buffer)]
        except BaseException as error:
            self._refuse(error)
            return [False] * len(vrs)

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """As `set_real`."""
        try:
            self._write(self._settable(vrs, "Boolean"), [1.0 if value else 0.0 for value in values])
        except BaseException as error:
            self._refuse(error)

    def get_string(self, vrs: list[int]) -> list[str]:
        """As `get_real`; empty texts when the call is refused."""
        try:
            return [self._strings[slot] for slot in self._gettable(vrs, "String").slots]
        except BaseException as error:
            self._refuse(error)
            return [""] * len(vrs)

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """Store all texts; they are read at initialisation."""
        try:
            slots = self._settable(vrs, "String").slots
            if not all(isinstance(value, str) for value in values):
                raise RefusalError("a null pointer is not a text and cannot be set; the old texts are kept")
            self._strings.update(zip(slots, values, strict=True))
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
        except PLAIN as error:
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
        misfit = where.store(self._store, self._address, values)
        if misfit:
            raise RefusalError(complaint(self.description_.ports[where.slots[misfit - 1]], values[misfit - 1]))
