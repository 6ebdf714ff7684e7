"""FMUs as slaves: FMPy loads, checks and owns them; the hot loop's calls go straight to the C functions."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

from cosim.engine.messages import Mailbox, callbacks
from cosim.engine.slave import ERROR, OK, WARNING, Call, Calls, Memory, SlaveError, do_nothing
from cosim.engine.transfer import get_texts, get_whole_numbers, in_turn, set_texts, set_whole_numbers
from cosim.errors import CosimError
from cosim.model.face import Face, Value
from cosim.model.signals import Vector

_TRANSFERS = {"Get": (get_whole_numbers, get_texts), "Set": (set_whole_numbers, set_texts)}
_FATAL = 4
_TERMINATED = 3  # of fmi2StatusKind
_WHOLE = {"Integer": ("Integer", "Enumeration"), "Boolean": ("Boolean",)}
"""Types of variables by the names of the functions that carry them."""


@dataclass
class Library:
    """An FMU unpacked in `folder`. After a fatal error none of its instances may be called (FMI 2.0.4, 2.1.3)."""

    face: Face
    folder: Path
    fatal: bool = False


class FmuSlave:
    """One instance of an FMU. What may be called at its end depends on how far it came and how it failed."""

    def __init__(self, name: str, library: Library) -> None:
        face = self.face = library.face
        self._name, self._library = name, library
        self._raw = face.tool.startswith("PythonFMU")
        self._mailbox = Mailbox()
        self._callbacks = callbacks(self._mailbox, formatted=not self._raw)  # the FMU keeps a pointer to them
        try:
            with contextlib.chdir("."):  # FMPy goes to the library, and stays there when it cannot be loaded
                self._fmu = FMU2Slave(
                    instanceName=name,
                    guid=face.guid,
                    modelIdentifier=face.identifier,
                    unzipDirectory=str(library.folder),
                )
            self._fmu.instantiate(callbacks=self._callbacks, loggingOn=True)
        except Exception as error:
            reason = self.message() or " ".join(str(error).split())
            raise CosimError(f"cannot instantiate {name} ({face.model}): {reason}") from None
        self._steps = self._freed = False

    def set(self, values: Mapping[str, Value]) -> None:
        for name, value in values.items():
            port = self.face.ports[name]
            setter = {"Real": "setReal", "Boolean": "setBoolean", "String": "setString"}.get(port.type, "setInteger")
            self._call(setter, [port.reference], [value])

    def enter(self) -> None:
        self._call("setupExperiment", startTime=0.0)
        self._call("enterInitializationMode")

    def leave(self) -> None:
        self._call("exitInitializationMode")
        self._steps = True

    def bind(self, memory: Memory) -> Calls:
        component, raw = self._fmu.component, self._fmu.dll.__getitem__  # fresh functions, without FMPy's wrappers
        return Calls(
            self._transfer("Set", memory.inputs, memory.u, memory.written, memory.w),
            partial(raw("fmi2DoStep"), _pointer(component), memory.time, memory.step, c_int(1)),
            self._transfer("Get", memory.outputs, memory.y, memory.texts, memory.z),
        )

    def save(self) -> bytes:
        state = self._call("getFMUState")
        try:
            return bytes(self._call("serializeFMUState", state))
        finally:
            self._call("freeFMUState", state)

    def restore(self, data: bytes) -> None:
        state = self._call("deserializeFMUState", data)
        try:
            self._call("setFMUState", state)
        finally:
            self._call("freeFMUState", state)

    def failed(self, status: int) -> None:
        self._library.fatal |= status >= _FATAL
        self._steps &= status < ERROR

    def ended(self) -> bool:
        if self._raw:  # PythonFMU's library answers yes after every discard
            return False
        over = c_int(0)
        ask = self._fmu.dll["fmi2GetBooleanStatus"]
        return ask(_pointer(self._fmu.component), c_int(_TERMINATED), byref(over)) == OK and bool(over.value)

    def message(self) -> str:
        text = self._mailbox.text
        return text.replace("%%", "%") if self._raw else text

    def close(self) -> None:
        if self._freed or self._library.fatal:
            return
        self._freed = True
        with contextlib.suppress(Exception):
            if self._steps:
                self._fmu.terminate()
        with contextlib.suppress(Exception):
            if not self._library.fatal:
                self._fmu.freeInstance()

    def _transfer(
        self, way: str, names: Sequence[str], values: Vector, written: Sequence[str], texts: list[str]
    ) -> Call:
        """One call for the Real variables, and one for each other type there is; `way` is Get or Set."""
        raw = self._fmu.dll.__getitem__
        whole_numbers, strings = _TRANSFERS[way]
        types = [self.face.ports[name].type for name in names]
        calls = [self._reals(raw(f"fmi2{way}Real"), names[: types.count("Real")], values)] if "Real" in types else []
        for function, of in _WHOLE.items():
            places = [i for i, type_ in enumerate(types) if type_ in of]
            if places:
                some = slice(places[0], places[-1] + 1)
                calls.append(whole_numbers(raw(f"fmi2{way}{function}"), self._arguments(names[some]), values[some]))
        if written:
            calls.append(strings(raw(f"fmi2{way}String"), self._arguments(written), texts))
        return in_turn(calls) if calls else do_nothing

    def _arguments(self, names: Sequence[str]) -> tuple[Any, Any, c_size_t]:
        references = (c_uint * len(names))(*(self.face.ports[name].reference for name in names))
        return _pointer(self._fmu.component), references, c_size_t(len(names))

    def _reals(self, function: Any, names: Sequence[str], values: Vector) -> Call:
        memory = (c_double * len(names)).from_buffer(values.data)
        return partial(function, *self._arguments(names), memory)

    def _call(self, function: str, *args: object, **options: object) -> Any:
        try:
            return getattr(self._fmu, function)(*args, **options)
        except FMICallException as error:
            if error.status > WARNING:
                self.failed(error.status)
                raise SlaveError(self._name, error.status, self.message()) from None


def _pointer(component: Any) -> Any:
    return component if isinstance(component, c_void_p) else c_void_p(component)
