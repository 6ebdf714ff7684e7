"""Rows of the signal vector: the latest in an Arrow stream, all before in Parquet, so that a killed run keeps them."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from ctypes import c_double
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import pyarrow as pa

from cosim.model.clock import SECOND, to_seconds
from cosim.model.patterns import matches_any
from cosim.model.signals import Signal, Vector
from cosim.results.columns import Batch, Texts, schema_of
from cosim.results.growing import Growing
from cosim.results.storage import BEFORE, STREAM, group_rows, groups, sink

_ROWS, CHUNK_VALUES = 512, 1 << 17  # in a chunk, at most
SPAN_VALUES = 1 << 23
_PATIENCE = 2.0  # [s] of wall time
_ARRAY = re.compile(r"\[\d+]")


def recorded(signals: Iterable[Signal], unrecorded: Sequence[str] = ()) -> list[int]:
    """Which signals (by position) are recorded: all but those that fit a pattern of `unrecorded`.

    Elements of array signals like preview[3].x never are.
    """
    found = [(i, signal) for i, signal in enumerate(signals) if not _ARRAY.search(signal.variable)]
    return [i for i, signal in found if not matches_any(signal.name, unrecorded)]


class Recorder:
    """Call it once per tick. `vector` is [time, signals...]; `chosen` are positions in `signals`; `folder` exists.

    With `every` [ns] only the first call at or after each multiple of it makes a row, and the one at `stop` [ns].
    Rows are gathered in a chunk and appended to the stream whenever it is full. Of a long run, whose number of `rows`
    is known, the stream is moved into the Parquet file now and then, and begun again: neither memory nor disk have to
    hold the run twice. `about` becomes the file's metadata, `texts` are recorded beside the vector.
    """

    def __init__(
        self,
        folder: Path,
        vector: Vector,
        signals: Sequence[Signal],
        chosen: Sequence[int],
        every: int = 0,
        stop: int | None = None,
        about: Mapping[bytes, bytes] | None = None,
        texts: Texts | None = None,
        rows: int | None = None,
    ) -> None:
        self._folder = folder
        self._every, self._stop = every, stop
        self._clock, self._next = c_double.from_buffer(vector.data), -math.inf
        self._index = np.array([0, *(1 + i for i in chosen)])
        self._chunk = np.zeros((min(_ROWS, 1 + CHUNK_VALUES // len(self._index)), len(self._index)))
        self._rows = list(self._chunk)
        self._columns = np.zeros(self._chunk.T.shape)
        kept = [*(signals[i] for i in chosen), *(texts.signals if texts else ())]
        self._schema = schema_of(kept, about)
        self._batch = Batch(self._columns, self._schema)
        self._texts = texts or Texts((), ())
        self._said: list[list[str]] = []
        self._take = vector.take
        self._expected, self._span = rows, _span(rows, len(self._schema))
        self._growing = Growing(folder, self._schema)
        self._filled = self._written = 0
        self._begin()

    def __call__(self) -> None:
        if self._clock.value < self._next:
            return
        self._take(self._index, None, self._rows[self._filled], "clip")
        self._filled += 1
        if self._texts.signals:
            self._said.append(list(self._texts.values))
        if self._every:
            self._next = self._due(self._clock.value)
        if self._filled == self._full:
            self.flush()

    @property
    def rows(self) -> int:
        """How many rows there are so far."""
        return self._written + self._filled

    def refill(self, table: Any) -> None:
        """Take the rows of an earlier recording with the same signals, before any of its own."""
        numbers, names = len(self._index), self._schema.names
        kept = self._take(self._index)  # of an input that only now is recorded: what it has held
        for batch in table.to_batches(max_chunksize=len(self._rows)):
            known = dict(zip(batch.schema.names, batch.columns, strict=True))
            columns = [
                np.asarray(known[name].to_numpy(zero_copy_only=False), float)
                if name in known
                else np.full(batch.num_rows, kept[i])
                for i, name in enumerate(names[:numbers])
            ]
            words = [known[name].to_pylist() for name in names[numbers:]]
            for k in range(batch.num_rows):
                self._rows[self._filled][:] = [column[k] for column in columns]
                self._filled += 1
                if words:
                    self._said.append([column[k] for column in words])
                if self._filled == self._full:
                    self.flush()
        if self._every and table.num_rows:
            self._next = self._due(float(table.column("time")[-1].as_py()))

    def _begin(self) -> None:
        """A new stream, which says how many rows went before."""
        before = {**(self._schema.metadata or {}), BEFORE: str(self._written).encode()}
        self._sink = sink(self._folder / STREAM)
        self._writer = pa.ipc.new_stream(self._sink, self._schema.with_metadata(before))
        self._until = self._written + self._span
        self._append()  # an empty chunk writes the schema, so that the stream can be read from now on

    def _due(self, time: float) -> float:
        """When the next row after that at `time` is due [s]."""
        now = round(time * SECOND)
        later = (now // self._every + 1) * self._every
        return to_seconds(later if self._stop is None else min(later, self._stop))

    def flush(self) -> None:
        """Append the rows gathered so far to the stream, and move it into the Parquet file when it is long enough."""
        self._append()
        if self._written == self._until:
            self._end_stream()
            self._growing.append(groups(self._folder / STREAM, self._group()))
            self._begin()

    def _append(self) -> None:
        """Append the rows gathered so far to the stream and hand them to the operating system.

        OSError (a full disk) ends the recording: the stream keeps its whole chunks, `close` writes nothing more to it.
        """
        whole = self._sink.tell()
        self._columns[:, : self._filled] = self._chunk[: self._filled].T  # the batch shows this memory
        try:
            self._writer.write_batch(self._batch.first(self._filled, self._said))
        except OSError:
            self._sink.close()
            os.truncate(self._folder / STREAM, whole)
            raise
        self._written += self._filled
        self._filled = 0
        self._said.clear()
        self._full = min(len(self._rows), self._until - self._written)
        self._flushed = monotonic()

    def keep(self) -> None:
        """Flush what has waited for a while: called now and then, so that a slow run loses little when killed."""
        if self._filled and monotonic() - self._flushed > _PATIENCE:
            self.flush()

    def close(self) -> None:
        """Move the rest of the stream into results.parquet, then remove the stream.

        When the disk is full this raises OSError, and what was recorded is in whichever files are there.
        """
        try:
            if self._filled and not self._sink.closed:
                self._append()
        finally:
            if not self._sink.closed:
                self._end_stream()
            self._sink.close()
            stream = self._folder / STREAM
            if self._written > self._growing.rows or not self._written:
                self._growing.append(groups(stream, self._group()), last=True)
            self._growing.finish()
            stream.unlink()

    def _end_stream(self) -> None:
        self._writer.close()
        self._sink.close()

    def _group(self) -> int:
        return group_rows(max(1, self._expected or self._written), len(self._schema))


def _span(rows: int | None, columns: int) -> int:
    """How many rows the stream takes before it is moved: whole row groups, of about `SPAN_VALUES` values at least."""
    if rows is None:
        return 1 << 62
    group = group_rows(max(1, rows), columns)
    return group * max(1, round(SPAN_VALUES / (group * columns)))
