"""How much a run is going to record, and what a user should know of it before it starts."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

from cosim.engine.schedule import Schedule
from cosim.model.node import Node
from cosim.run.request import Request

_LARGE = 500e6
_PACKED = 0.5
"""Of what the values take in memory, what they take in the file: the usual share of recorded drives."""


def expected_rows(request: Request, schedule: Schedule, nodes: Mapping[str, Node]) -> int:
    """How many rows the run records at most: one every so often, or at every tick at which something is due."""
    ticks = min(request.stop // schedule.tick, sum(request.stop // node.period + 1 for node in nodes.values()))
    return 1 + (min(ticks, request.stop // request.interval + 1) if request.interval else ticks)


def remarks(rows: int, columns: int, folder: Path) -> Iterator[str]:
    """Sentences on results that are large, or larger than the disk has room for."""
    size = _PACKED * 8 * rows * columns
    if size < _LARGE:
        return
    what = f"the results will take about {_gigabytes(size)} ({rows} rows of {columns} values)"
    free = shutil.disk_usage(folder).free
    if free < 1.2 * size:
        yield f"{what}, but {folder} has {_gigabytes(free)} free; --record-every S records fewer rows"
    else:
        yield f"{what}; --record-every S records fewer rows"


def _gigabytes(size: float) -> str:
    return f"{size / 1e9:.1f} GB"
