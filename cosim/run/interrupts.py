"""Ctrl-C and SIGTERM as a flag that the master looks at."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any


@contextmanager
def interrupts() -> Iterator[Callable[[], bool]]:
    """A flag that Ctrl-C and SIGTERM raise; a second Ctrl-C acts at once.

    An exception would surface inside whichever FMU happens to run Python code, and be taken for its fault.
    """
    asked = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield asked.is_set
        return

    def ask(number: int, _frame: object) -> None:
        asked.set()
        signal.signal(number, previous[number])

    kinds = (signal.SIGINT, signal.SIGTERM)
    previous: dict[int, Any] = {kind: signal.signal(kind, ask) for kind in kinds}
    try:
        yield asked.is_set
    finally:
        for kind in kinds:
            signal.signal(kind, previous[kind])
