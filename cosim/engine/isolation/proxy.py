"""A slave whose FMU runs in a process of its own; to the master it is a slave like any other."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any

import numpy as np

from cosim.engine.fmu import Library
from cosim.engine.isolation.channel import EXCHANGE, GET, SET
from cosim.engine.isolation.process import Process
from cosim.engine.slave import ERROR, OK, WARNING, Calls, Memory, SlaveError
from cosim.errors import CosimError
from cosim.model.face import Value


class IsolatedSlave:
    """One instance of the FMU in `library`, in `process`; raises CosimError when it cannot be instantiated.

    A process that dies or does not answer in time is a SlaveError, as any other failure. What it was set is sent
    together with the step that takes it in: the three calls of the master are one round trip.
    """

    def __init__(self, name: str, library: Library, process: Process) -> None:
        self.face = library.face
        self._name, self._process = name, process
        self._message, self._ended = "", False
        self._waiting = False
        self._control("fmi2Instantiate", "make", name, library)

    def set(self, values: Mapping[str, Value]) -> None:
        self._control("fmi2Set", "set", dict(values))

    def enter(self) -> None:
        self._control("fmi2EnterInitializationMode", "enter")

    def leave(self) -> None:
        self._raise(self._take_in())
        self._control("fmi2ExitInitializationMode", "leave")

    def bind(self, memory: Memory) -> Calls:
        shared = self._process.share(len(memory.inputs), len(memory.outputs))
        names = (memory.inputs, memory.outputs, memory.texts, memory.written)
        self._control("fmi2Get", "bind", *map(tuple, names))
        clock, u, y = shared.clock, shared.u, shared.y
        call, note = self._process.call, self._note
        fresh, written = False, [""] * len(memory.written)

        def set_() -> int:
            u[:] = memory.u
            self._waiting = True
            if memory.w == written:
                return OK
            written[:] = memory.w
            return note(*self._process.control("write", written))

        def step() -> int:
            nonlocal fresh
            clock[0], clock[1] = memory.time.value, memory.step.value
            status, more = call(EXCHANGE)
            self._waiting, fresh = False, True
            return note(status, more, memory.z) if more else status

        def get() -> int:
            nonlocal fresh
            status = OK if fresh else max(self._take_in(), note(*call(GET), memory.z))
            fresh = False
            if status <= WARNING:
                np.copyto(memory.y, y)
            return status

        return Calls(set_, step, get)

    def save(self) -> bytes:
        text = str(self._control("fmi2SerializeFMUstate", "save"))
        try:
            return base64.b64decode(text, validate=True)
        except ValueError:
            raise SlaveError(self._name, ERROR, "its process gave bytes that are no state") from None

    def restore(self, data: bytes) -> None:
        self._control("fmi2SetFMUstate", "restore", data)

    def failed(self, status: int) -> None:
        """The process knows: its own call came back with it."""

    def ended(self) -> bool:
        return self._ended

    def message(self) -> str:
        return self._process.lost or self._message

    def close(self) -> None:
        self._process.close()

    def _take_in(self) -> int:
        """Let the FMU take the inputs that wait for a step, outside of steps."""
        waiting, self._waiting = self._waiting, False
        return self._note(*self._process.call(SET)) if waiting else OK

    def _note(self, status: int, more: dict[str, Any], texts: list[str] | None = None) -> int:
        """Keep what came with a status."""
        self._message = str(more.get("message", self._message))
        self._ended = bool(more.get("ended"))
        if texts is not None and isinstance(more.get("texts"), list):
            texts[:] = [str(text) for text in more["texts"]][: len(texts)]
        return status

    def _control(self, told: str, name: str, *arguments: Any) -> Any:
        status, more = self._process.control(name, *arguments, told=told)
        if "mistake" in more:
            raise CosimError(str(more["mistake"]))
        self._raise(self._note(status, more))
        return more.get("value")

    def _raise(self, status: int) -> None:
        if status > WARNING:
            raise SlaveError(self._name, status, self.message())
