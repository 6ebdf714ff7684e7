"""The terminal: a console, notices, and the progress of a run. Everything that is not a result goes to stderr."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from cosim.model.clock import to_seconds

_REFRESH = 0.1  # [s] of wall time between two updates of the progress bar


class _Notices(logging.Handler):
    """One line on whatever stderr is at the time."""

    def emit(self, record: logging.LogRecord) -> None:
        print(f"cosim: {record.getMessage()}", file=sys.stderr)


def notices(*, shown: bool) -> None:
    """Send what is worth a sentence, such as a plan being made, to stderr, or nowhere."""
    log = logging.getLogger("cosim")
    log.handlers = [_Notices()] if shown else [logging.NullHandler()]
    log.setLevel(logging.INFO)


@contextmanager
def progress(stop: float, *, shown: bool) -> Iterator[Callable[[int], None]]:
    """A progress callback for the master: simulated time and real-time factor, refreshed ten times a second."""
    console = Console(stderr=True)
    if not (shown and console.is_terminal):
        yield lambda _time: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[factor]}"), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, auto_refresh=False) as bar:
        task = bar.add_task("preparing", total=stop, factor="")
        started = shown_at = 0.0

        def update(time: int) -> None:
            nonlocal started, shown_at
            now = perf_counter()
            started = started or now
            if now - shown_at > _REFRESH:
                shown_at, seconds = now, to_seconds(time)
                factor = seconds / (now - started) if now > started else 0.0
                text = f"{seconds:.2f} of {stop:g} s"
                bar.update(task, completed=seconds, description=text, factor=f"{factor:.1f} x real time", refresh=True)

        bar.refresh()
        yield update
