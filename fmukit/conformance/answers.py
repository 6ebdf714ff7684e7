"""The channel on which a worker answers: every answer bears the key of its question, and nothing else is one.

The FMU runs inside the worker and can write on every descriptor it finds there. It does not know the key, which is
drawn anew for every question and which the worker reads only then.
"""

from __future__ import annotations

import json
import os
import queue
import secrets
import threading
from collections.abc import Sequence
from contextlib import suppress
from typing import IO, Any

_MOST_PIECES = 64
_MOST_STRAYS = 100
_LONGEST = 16 << 20


class Listener:
    """The side that asks. `strays` are lines that answered nothing, in quotes and cut short."""

    def __init__(self, questions: IO[bytes], answers: IO[bytes]) -> None:
        self._questions, self._key, self._rest = questions, "", b""
        self._heard: dict[str, Any] | None = None
        self._pieces: queue.Queue[bytes] = queue.Queue(_MOST_PIECES)
        self.strays: list[str] = []
        self.open = True
        threading.Thread(target=_read, args=(answers, self._pieces), daemon=True).start()

    def ask(self, rule: str) -> None:
        """Put the question for a rule; nobody may be there to read it."""
        self._key, self._heard = secrets.token_hex(16), None
        with suppress(OSError):
            self._questions.write(json.dumps({"rule": rule, "key": self._key}).encode() + b"\n")
            self._questions.flush()

    def listen(self, seconds: float) -> bool:
        """Wait that long for a piece of an answer; whether there was one. After the last one it is not `open`."""
        if not self.open:
            return False
        try:
            data = self._pieces.get(timeout=seconds) if seconds > 0 else self._pieces.get_nowait()
        except queue.Empty:
            return False
        self.open = bool(data)
        *lines, self._rest = (self._rest + data).split(b"\n")
        if self._rest and (not data or len(self._rest) > _LONGEST):
            lines, self._rest = [*lines, self._rest], b""
        for line in lines:
            if line.strip():
                self._take(line)
        return self.open

    def answer(self) -> tuple[str, tuple[str, ...]] | None:
        """The status and the sentences of the answer to the last question, None until there is one."""
        if self._heard is None:
            return None
        return str(self._heard["status"]), tuple(map(str, self._heard["seen"]))

    def _take(self, line: bytes) -> None:
        try:
            event = json.loads(line)
            fits = event.keys() == {"key", "status", "seen"} and secrets.compare_digest(str(event["key"]), self._key)
            sound = fits and self._heard is None and event["status"] in ("pass", "fail", "skip")
        except (ValueError, AttributeError, TypeError, RecursionError):
            sound = False
        if sound:
            self._heard = event
        elif len(self.strays) < _MOST_STRAYS:
            self.strays.append(repr(line[:60].decode("utf-8", "replace")))


def _read(answers: IO[bytes], pieces: queue.Queue[bytes]) -> None:
    with suppress(OSError, ValueError):
        while data := answers.read1(1 << 16):  # type: ignore[attr-defined]
            pieces.put(data)
    pieces.put(b"")


def answer(channel: int, key: str, status: str, seen: Sequence[str]) -> None:
    """Answer the question that bears the key, on a line of its own whatever stands before it in the channel."""
    text = f"\n{json.dumps({'key': key, 'status': status, 'seen': list(seen)})}\n"
    data = text.encode("utf-8", "replace")
    while data:
        data = data[os.write(channel, data) :]
