"""Ctrl-C, SIGTERM and SIGHUP as a flag that the master looks at."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from fmukit.command_line import interrupting

_PATIENCE = 2


@contextmanager
def interrupts() -> Iterator[Callable[[], bool]]:
    """A flag that these signals raise. From the third on they act at once and end a process that hangs.

    An exception would surface inside whichever FMU happens to run Python code, and be taken for its fault.
    """
    asked = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield asked.is_set
        return

    count = 0

    def ask(number: int, _frame: object) -> None:
        nonlocal count
        asked.set()
        count += 1
        if count >= _PATIENCE:
            signal.signal(number, signal.SIG_DFL)

    kinds = interrupting()
    previous: dict[int, Any] = {kind: signal.signal(kind, ask) for kind in kinds}
    try:
        yield asked.is_set
    finally:
        for kind in kinds:
            signal.signal(kind, previous[kind])
