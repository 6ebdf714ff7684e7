"""The files of results: the Arrow stream of a run, and the row groups of the Parquet file made from it."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import parquet

from cosim.results.columns import is_plain

STREAM = "results.arrows"
PARQUET = "results.parquet"
BEFORE = b"rows_before"
"""The key of the metadata of a stream under which stands how many rows of the run went before its first."""
GROUP_VALUES = 1 << 19
"""Values that a row group of the Parquet file holds whatever the number of its rows."""
COLUMN_OVERHEAD = 256
"""Values that take as much memory as what is kept of a column of a row group until the file is written."""


def sink(path: Path) -> Any:
    """A new file to write into, whatever bytes its name has; what was there is removed, be it a link."""
    path.unlink(missing_ok=True)
    return pa.OSFile(os.fsencode(path), "wb")


def open_parquet(path: Path) -> Any:
    """The Parquet file, whatever bytes its name has."""
    return parquet.ParquetFile(pa.OSFile(os.fsencode(path)))


def read_stream(path: Path) -> Any:
    """The table of a stream file, up to its last complete chunk if the run was killed."""
    with path.open("rb") as source:
        reader = pa.ipc.open_stream(source)
        return pa.Table.from_batches(_batches(reader), reader.schema)


def _batches(reader: Any) -> Iterator[Any]:
    while True:
        try:
            yield reader.read_next_batch()
        except (StopIteration, pa.ArrowInvalid, OSError):
            return


def groups(stream: Path, size: int) -> Iterator[Any]:
    """The content of a stream file as tables of `size` rows, the last one of what is left."""
    with stream.open("rb") as source:
        reader = pa.ipc.open_stream(source)
        yield from (_plain_groups if is_plain(reader.schema) else _mixed_groups)(reader, size)


def _plain_groups(reader: Any, size: int) -> Iterator[Any]:
    """Tables of equally many rows but for the last, however long the chunks are, which a slow run cuts shorter.

    All show the same memory, each until the next is asked for. Arrow's own concatenation of a few rows of thousands of
    columns takes many times the memory of their values.
    """
    group, filled = np.empty((len(reader.schema), size)), 0
    for batch in _batches(reader):
        values = batch.to_tensor(row_major=False).to_numpy().T if len(batch) else group[:, :0]
        while values.shape[1]:
            part = values[:, : group.shape[1] - filled]
            group[:, filled : filled + part.shape[1]] = part
            filled, values = filled + part.shape[1], values[:, part.shape[1] :]
            if filled == group.shape[1]:
                yield pa.Table.from_arrays([pa.array(column) for column in group], schema=reader.schema)
                filled = 0
    if filled:
        yield pa.Table.from_arrays([pa.array(column) for column in group[:, :filled]], schema=reader.schema)


def _mixed_groups(reader: Any, size: int) -> Iterator[Any]:
    """As `_plain_groups`, of columns of several types, through Arrow's own concatenation."""
    kept, filled = [], 0
    for batch in _batches(reader):
        while len(batch):
            part = batch.slice(0, size - filled)
            kept.append(part)
            filled, batch = filled + len(part), batch.slice(len(part))  # noqa: PLW2901
            if filled == size:
                yield pa.Table.from_batches(kept, reader.schema).combine_chunks()
                kept, filled = [], 0
    if filled:
        yield pa.Table.from_batches(kept, reader.schema).combine_chunks()


def group_rows(rows: int, columns: int) -> int:
    """How many rows make a row group: of n groups of wide rows the memory is columns (rows / n + n overhead) values.

    It is least at n = sqrt(rows / overhead).
    """
    return max(1, min(rows, max(math.isqrt(COLUMN_OVERHEAD * rows), 1 + GROUP_VALUES // columns)))
