"""A Parquet file that grows while a run lasts, and is whole whenever the process is killed.

Row groups are appended to `results.partial`. What would be its end, the footer, is kept beside it in `results.footer`,
which is replaced at once: both together are a Parquet file at any time. When the run is over they become one.
"""

from __future__ import annotations

import io
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pyarrow as pa
from pyarrow import parquet

from cosim.results.storage import PARQUET
from fmukit import files

PARTIAL = "results.partial"
FOOTER = "results.footer"
_MAGIC, _COUNT = b"PAR1", 8


class Growing:
    """The Parquet file of a run into `folder`, with columns as `schema` says; `rows` are in it so far."""

    def __init__(self, folder: Path, schema: Any) -> None:
        self._folder, self._path, self._schema = folder, folder / PARTIAL, schema
        self._metadata: Any = None
        self.rows = 0

    def append(self, groups: Iterable[Any], *, last: bool = False) -> None:
        """Append tables as row groups; the `last` ones need no footer of their own, as `finish` follows.

        On OSError the file is as it was before.
        """
        before = self._path.stat().st_size if self.rows else 0
        try:
            metadata = self._appended(groups)
            self._cut_footer()
            if self._metadata is None:
                self._metadata = metadata
            else:
                self._metadata.append_row_groups(metadata)
            if not last:
                whole = self._path.stat().st_size
                files.write(self._folder / FOOTER, whole.to_bytes(_COUNT, "little") + self._footer())
        except OSError:
            if before:
                os.truncate(self._path, before)
            else:
                self._path.unlink(missing_ok=True)
            raise
        self.rows = self._metadata.num_rows

    def finish(self) -> None:
        """Make it results.parquet, which then is whole."""
        before = self._path.stat().st_size
        try:
            with self._path.open("ab") as file:
                file.write(self._footer())
        except OSError:
            os.truncate(self._path, before)
            raise
        self._path.replace(self._folder / PARQUET)
        (self._folder / FOOTER).unlink(missing_ok=True)

    def _appended(self, groups: Iterable[Any]) -> Any:
        """What is known of the groups once they are written, with places that count from the beginning of the file."""
        if not self.rows:
            self._path.unlink(missing_ok=True)  # be it a link
        found: list[Any] = []
        with pa.OSFile(os.fsencode(self._path), "ab") as target:
            # Arrow begins a Parquet file at place 0 only. It is told so, and finds itself at the end of the file once
            # it has written its first letters, as the system appends whatever is written to a file opened like this.
            os.lseek(target.fileno(), 0, os.SEEK_SET)
            options = {"compression": "zstd", "use_dictionary": False, "metadata_collector": found}
            with parquet.ParquetWriter(target, self._schema, **options) as writer:
                for group in groups:
                    writer.write_table(group)
        return found[0]

    def _cut_footer(self) -> None:
        """Take away the footer that Arrow has written, which tells of the last groups only."""
        with self._path.open("rb+") as file:
            end = file.seek(-len(_MAGIC) - 4, os.SEEK_END)
            length = int.from_bytes(file.read(4), "little")
            file.truncate(end - length)

    def _footer(self) -> bytes:
        """The footer of all groups so far."""
        sink = pa.BufferOutputStream()
        self._metadata.write_metadata_file(sink)
        return bytes(sink.getvalue().to_pybytes()[len(_MAGIC) :])


def is_unfinished(folder: Path) -> bool:
    """Whether a killed run has left row groups in the folder."""
    return (folder / FOOTER).is_file() and (folder / PARTIAL).is_file()


def open_unfinished(folder: Path) -> Any:
    """The Parquet file that a killed run has left in two."""
    data = (folder / FOOTER).read_bytes()
    spliced = _Spliced((folder / PARTIAL).open("rb"), int.from_bytes(data[:_COUNT], "little"), data[_COUNT:])
    return parquet.ParquetFile(pa.PythonFile(spliced, "r"))


class _Spliced(io.RawIOBase):
    """The first `length` bytes of a file, and an `end` after them."""

    def __init__(self, file: io.BufferedReader, length: int, end: bytes) -> None:
        self._file, self._length, self._end = file, length, end
        self._place = 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._place

    def seek(self, place: int, whence: int = os.SEEK_SET) -> int:
        start = {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._length + len(self._end)}[whence]
        self._place = start + place
        return self._place

    def read(self, size: int | None = -1) -> bytes:
        whole = self._length + len(self._end)
        stop = whole if size is None or size < 0 else min(whole, self._place + size)
        data = b""
        if self._place < self._length:
            self._file.seek(self._place)
            data = self._file.read(min(stop, self._length) - self._place)
        if stop > self._length:
            data += self._end[max(0, self._place - self._length) : stop - self._length]
        self._place = stop
        return data

    def close(self) -> None:
        self._file.close()
        super().close()
