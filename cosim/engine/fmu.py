"""FMUs as slaves: FMPy loads, checks and owns them; the hot loop's calls go straight to the C functions."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping, Sequence
from ctypes import c_double, c_int, c_size_t, c_uint, c_void_p
from functools import partial
from pathlib import Path
from typing import Any

from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

from cosim.engine.messages import Mailbox, callbacks
from cosim.engine.slave import WARNING, Call, Calls, Memory, SlaveError, do_nothing
from cosim.errors import CosimError
from cosim.model.face import Face, Value
from cosim.model.signals import Vector

_ERROR = 3


class FmuSlave:
    """One instance of the FMU unpacked in `folder`."""

    def __init__(self, name: str, face: Face, folder: Path) -> None:
        self.face = face
        self._name = name
        self._raw = face.tool.startswith("PythonFMU")
        self._mailbox = Mailbox()
        self._callbacks = callbacks(self._mailbox, formatted=not self._raw)  # the FMU keeps a pointer to them
        try:
            self._fmu = FMU2Slave(
                instanceName=name, guid=face.guid, modelIdentifier=face.identifier, unzipDirectory=str(folder)
            )
            self._fmu.instantiate(callbacks=self._callbacks, loggingOn=True)
        except Exception as error:
            reason = self.message() or " ".join(str(error).split())
            raise CosimError(f"cannot instantiate {name} ({face.model}): {reason}") from None
        self._dead = False

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

    def bind(self, memory: Memory) -> Calls:
        component, raw = self._fmu.component, self._fmu.dll.__getitem__  # fresh functions, without FMPy's wrappers
        return Calls(
            self._transfer(raw("fmi2SetReal"), memory.inputs, memory.u),
            partial(raw("fmi2DoStep"), _pointer(component), memory.time, memory.step, c_int(1)),
            self._transfer(raw("fmi2GetReal"), memory.outputs, memory.y),
        )

    def message(self) -> str:
        text = self._mailbox.text
        return text.replace("%%", "%") if self._raw else text

    def close(self) -> None:
        if self._dead:
            return
        with contextlib.suppress(Exception):
            self._fmu.terminate()
        with contextlib.suppress(Exception):
            self._fmu.freeInstance()
        self._dead = True

    def _transfer(self, function: Any, names: Sequence[str], values: Vector) -> Call:
        if not names:
            return do_nothing
        references = (c_uint * len(names))(*(self.face.ports[name].reference for name in names))
        memory = (c_double * len(names)).from_buffer(values.data)
        return partial(function, _pointer(self._fmu.component), references, c_size_t(len(names)), memory)

    def _call(self, function: str, *args: object, **options: object) -> None:
        try:
            getattr(self._fmu, function)(*args, **options)
        except FMICallException as error:
            if error.status > WARNING:
                self._dead = error.status > _ERROR
                raise SlaveError(self._name, error.status, self.message()) from None


def _pointer(component: Any) -> Any:
    return component if isinstance(component, c_void_p) else c_void_p(component)
