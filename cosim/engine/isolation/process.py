"""The process of an isolated instance as the master sees it: calls that come back, or a reason why not."""

from __future__ import annotations

import os
import pickle
import socket
import struct
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

import cosim
from cosim.engine.isolation.channel import CALLS, CONTROL, MORE, Cut, Garbled, Shared, memory_file, more_of, send
from cosim.engine.slave import CRASH, HANG
from cosim.errors import CosimError
from fmukit.errors import because
from fmukit.guard.guarded import Guarded
from fmukit.guard.keeper.limits import Limits

_LIMITS = Limits(file=None, interval=1.0)
_GRACE = 5.0
"""[s] in which a process that closed its channel ends, and in which an instance is freed."""


class Process:
    """A worker under guard, started at once; a call that takes longer than `timeout` [s] ends it."""

    def __init__(self, timeout: float) -> None:
        if sys.platform == "win32":
            raise CosimError("instances cannot be isolated on Windows; leave --isolate out")
        self.timeout = timeout
        self.lost = ""
        self._descriptor = memory_file()
        self._shared = Shared(self._descriptor)
        self._channel, theirs = socket.socketpair()
        with theirs:
            _limit(self._channel, timeout)
            self._guarded = _started(theirs, self._descriptor)

    def share(self, inputs: int, outputs: int) -> Shared:
        """Memory for so many numbers."""
        self._shared = Shared(self._descriptor, inputs, outputs)
        return self._shared

    def call(self, kind: bytes) -> tuple[int, dict[str, Any]]:
        """The status of a call, and what else was answered; CRASH or HANG, with the reason in `lost`."""
        if self.lost:
            return CRASH, {}
        channel = self._channel
        try:
            channel.send(kind)
            found = channel.recv(1)
            if found and found[0] < MORE:
                return found[0], {}
            return self._rest(found)
        except (OSError, Cut, Garbled) as error:
            return self._lost(error, "")

    def control(self, name: str, *arguments: Any, told: str = "") -> tuple[int, dict[str, Any]]:
        """As `call`, with arguments; `told` is what the call is called in a sentence."""
        if self.lost:
            return CRASH, {}
        try:
            send(self._channel, CONTROL, pickle.dumps((name, arguments)))
            return self._rest(self._channel.recv(1))
        except (OSError, Cut, Garbled) as error:
            return self._lost(error, told)

    def _rest(self, found: bytes) -> tuple[int, dict[str, Any]]:
        """The answer whose first byte is found."""
        if not found:
            raise Cut
        if found[0] < MORE:
            raise Garbled
        return found[0] - MORE, more_of(self._channel)

    def close(self) -> None:
        """Free the instance if it still answers, and end the process with all that it started."""
        if self._channel.fileno() < 0:
            return
        with suppress(OSError):
            _limit(self._channel, min(self.timeout, _GRACE))
        self.control("close")
        self._channel.close()
        self._guarded.wait(_GRACE)
        self._guarded.__exit__(None, None, None)
        with suppress(OSError):
            os.close(self._descriptor)

    def _lost(self, error: Exception, told: str) -> tuple[int, dict[str, Any]]:
        """What became of the process: it does not answer in time, answers nonsense, or has ended."""
        call = self._under_way(told)
        if isinstance(error, BlockingIOError):
            self._guarded.end()
            late = f"{call} did not return within {self.timeout:g} s"
            self.lost = f"{late}, so its process was ended; `--isolate-timeout` gives it longer"
            return HANG, {}
        if isinstance(error, Garbled):
            self._guarded.end()
            self.lost = f"its process gave an answer that is none in {call}, and was ended"
        else:
            ending = self._guarded.wait(_GRACE) or self._guarded.end()
            self.lost = f"its process {ending.words(_LIMITS)} in {call}"
        return CRASH, {}

    def _under_way(self, told: str) -> str:
        mark = min(self._shared.mark[0], len(CALLS) - 1)
        return CALLS[mark].format(told or "a call")


def _started(channel: socket.socket, descriptor: int) -> Guarded:
    root = str(Path(cosim.__file__).resolve().parents[1])
    path = os.pathsep.join([root, *filter(None, [os.environ.get("PYTHONPATH")])])
    numbers = channel.fileno(), descriptor
    try:
        return Guarded(
            [sys.executable, "-m", "cosim.engine.isolation.worker", *map(str, numbers)],
            limits=_LIMITS,
            stdout=2,
            stderr=2,
            env=os.environ | {"PYTHONPATH": path},
            pass_fds=numbers,
        )
    except OSError as error:
        raise CosimError(f"no process for an isolated instance can be started: {because(error)}") from None


def _limit(channel: socket.socket, seconds: float) -> None:
    """Let the operating system watch the time: Python's own time-out asks it once more per call."""
    whole = int(seconds)
    moment = struct.pack("@ll", whole, max(1, int((seconds - whole) * 1e6)))
    channel.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, moment)
    channel.setsockopt(socket.SOL_SOCKET, socket.SO_SNDTIMEO, moment)
