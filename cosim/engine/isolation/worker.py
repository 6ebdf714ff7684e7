"""The process that holds one FMU instance: it does what the master asks until the master lets go.

Arguments: the descriptors of the socket and of the shared memory. What the FMU prints goes to stderr.
"""

from __future__ import annotations

import base64
import ctypes
import os
import pickle
import signal
import socket
import sys
from collections.abc import Callable
from contextlib import suppress
from ctypes import c_double
from typing import Any

from cosim.engine.fmu import FmuSlave, Library
from cosim.engine.isolation.channel import CALLS, CONTROL, EXCHANGE, GET, SET, Shared, answer, receive
from cosim.engine.slave import DISCARD, OK, WARNING, Calls, Memory, SlaveError
from cosim.errors import CosimError
from cosim.model.face import Value

_SET, _STEP, _GET, _OTHER = range(1, len(CALLS))
_STATUSES = [bytes([status]) for status in range(6)]
_REFUSED = 3
Names = tuple[str, ...]


class Server:
    """Serves one instance over `channel`; `descriptor` is that of the shared memory."""

    def __init__(self, channel: socket.socket, descriptor: int) -> None:
        self._channel, self._descriptor = channel, descriptor
        self._shared = Shared(descriptor)
        self._said = ""
        self._texts: list[str] = []
        self._written: list[str] = []
        self._slave: FmuSlave
        self._calls: Calls

    def serve(self) -> None:
        """Until the other side closes the channel."""
        hot: dict[bytes, Callable[[], int]] = {EXCHANGE: self._exchange, SET: self._set, GET: self._get}
        while kind := self._channel.recv(1):
            if kind == CONTROL:
                name, arguments = pickle.loads(receive(self._channel))  # from the master
                self._control(name, arguments)
            else:
                self._tell(hot[kind]())

    def _exchange(self) -> int:
        """Set, step, get, as far as they succeed; which of them is under way can be read in the memory."""
        set_, step, get = self._calls
        mark = self._shared.mark
        mark[0] = _SET
        status = set_()
        if status <= WARNING:
            mark[0] = _STEP
            status = step()
            if status <= WARNING:
                mark[0] = _GET
                status = get()
        return status

    def _set(self) -> int:
        self._shared.mark[0] = _SET
        return self._calls.set()

    def _get(self) -> int:
        self._shared.mark[0] = _GET
        return self._calls.get()

    def _tell(self, status: int) -> None:
        """The status, and what else there is to know."""
        said = self._slave.message()
        if status <= WARNING and said == self._said and not self._texts:
            self._channel.send(_STATUSES[status])
            return
        more: dict[str, Any] = {"texts": self._texts} if self._texts else {}
        if status > WARNING:
            self._slave.failed(status)
            more["ended"] = status == DISCARD and self._slave.ended()
        answer(self._channel, status, more | self._news(said))

    def _news(self, said: str) -> dict[str, Any]:
        if said == self._said:
            return {}
        self._said = said
        return {"message": said}

    def _control(self, name: str, arguments: tuple[Any, ...]) -> None:
        self._shared.mark[0] = 0 if name == "make" else _OTHER
        try:
            value = getattr(self, f"do_{name}")(*arguments)
        except SlaveError as error:
            answer(self._channel, error.status, {"refused": True} | self._news(error.message))
        except CosimError as error:
            answer(self._channel, _REFUSED, {"mistake": str(error)})
        except Exception as error:  # such as a library without one of the functions
            answer(self._channel, _REFUSED, {"mistake": f"{type(error).__name__}: {error}"})
        else:
            answer(self._channel, OK, {"value": value} | self._news(self._slave.message()))

    def do_make(self, name: str, library: Library) -> None:
        """Instantiate the FMU."""
        self._slave = FmuSlave(name, library)

    def do_set(self, values: dict[str, Value]) -> None:
        self._slave.set(values)

    def do_enter(self) -> None:
        self._slave.enter()

    def do_leave(self) -> None:
        self._slave.leave()

    def do_bind(self, inputs: Names, outputs: Names, texts: Names, written: Names) -> None:
        """Bind the calls to the shared memory, which is large enough by now."""
        shared = self._shared = Shared(self._descriptor, len(inputs), len(outputs))
        time, step = (c_double.from_buffer(shared.clock[k : k + 1].data) for k in (0, 1))
        self._texts, self._written = [""] * len(texts), [""] * len(written)
        strings = texts, self._texts, written, self._written
        self._calls = self._slave.bind(Memory(time, step, inputs, shared.u, outputs, shared.y, *strings))

    def do_write(self, texts: list[str]) -> None:
        """Values of String inputs, which the FMU takes in with the next numbers."""
        self._written[:] = texts

    def do_save(self) -> str:
        return base64.b64encode(self._slave.save()).decode()

    def do_restore(self, data: bytes) -> None:
        self._slave.restore(data)

    def do_close(self) -> None:
        self._slave.close()


def main() -> None:
    """Serve, then end without asking the libraries of the FMU, some of which cannot leave in peace."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the master decides what an interrupt means
    channel, descriptor = map(int, sys.argv[1:])
    with suppress(OSError), socket.socket(fileno=channel) as open_channel:
        Server(open_channel, descriptor).serve()
    with suppress(OSError, ValueError):
        sys.stdout.flush()
        ctypes.CDLL(None).fflush(None)
    os._exit(0)


if __name__ == "__main__":
    main()
