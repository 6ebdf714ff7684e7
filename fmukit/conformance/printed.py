"""What a worker and the FMU inside it print: read as it comes, so that nobody waits, and all but the end forgotten."""

from __future__ import annotations

import threading
from typing import IO

_KEPT = 4096


class Printed:
    """Reads `stream` to its end in a thread of its own."""

    def __init__(self, stream: IO[bytes]) -> None:
        self._stream, self._end = stream, b""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        while data := self._stream.read1(1 << 16):  # type: ignore[attr-defined]
            self._end = (self._end + data)[-_KEPT:]

    def last(self) -> str:
        """The last line that is not blank, cut short, "" if there is none; to be asked after the end of the process."""
        self._reader.join(1.0)
        lines = self._end.decode("utf-8", "replace").splitlines()
        return next((line.strip()[:200] for line in reversed(lines) if line.strip()), "")
