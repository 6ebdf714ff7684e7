"""Reading the results of a run: columns as numpy arrays, units, and the rows at which an instance computed.

Of a Parquet file the columns are read when they are asked for, so that many vehicles need not fit into memory.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cosim.engine.slave import Vector
from cosim.errors import CosimError, unknown
from cosim.model.clock import SECOND
from cosim.model.face import Value
from cosim.results.storage import PARQUET, STREAM, read_stream


class Results:
    """`results["plant.yaw"]` is a column; `periods` [s] by instance name come from the run's summary.

    `settings` are those of the scenario that ran, by name; `parameters` by instance name what was set of its variables
    before the start, by the scenario or by hand. What is not among them had the start value of the model. `stop` [s] is
    when the run was to end; without it the last row is taken to be that time.
    """

    def __init__(
        self,
        table: Any,
        periods: Mapping[str, float],
        settings: Mapping[str, Any] | None = None,
        parameters: Mapping[str, Mapping[str, Value]] | None = None,
        stop: float | None = None,
    ) -> None:
        self._table = table
        self.periods = dict(periods)
        self.settings = dict(settings or {})
        self.parameters = dict(parameters or {})
        self.names = [name for name in table.schema.names if name != "time"]
        self._stop = stop
        self._known = frozenset(table.schema.names)
        self.time = table.column("time").to_numpy()

    def __contains__(self, name: str) -> bool:
        return name in self._known

    def __getitem__(self, name: str) -> Vector:
        if name not in self:
            raise unknown("signal", name, self.names, "the columns of results.parquet are the signals")
        return np.asarray(self._table.column(name).to_numpy())

    def unit(self, name: str) -> str:
        """The unit of a column, or an empty string."""
        metadata = self._table.schema.field(name).metadata or {}
        return str(metadata.get(b"unit", b"").decode())

    def instants(self, instance: str) -> np.ndarray:
        """The recorded rows at which `instance` computed.

        That of the stop time is left out: the plants have arrived, but no sampled instance has run.
        """
        period = round(self.periods[instance] * SECOND)
        nanoseconds = np.rint(self.time * SECOND).astype(np.int64)
        end = nanoseconds[-1:] if self._stop is None else self._stop * SECOND
        return np.flatnonzero((nanoseconds % period == 0) & (nanoseconds < np.rint(end)))

    def samples(self, instance: str, name: str) -> Vector:
        """The values of the variable `name` of `instance` at the rows at which it computed."""
        return np.asarray(self[f"{instance}.{name}"][self.instants(instance)])


class _Columns:
    """What `Results` needs of an Arrow table, out of an open Parquet file."""

    def __init__(self, path: Path) -> None:
        from pyarrow import parquet  # noqa: PLC0415  (slow to import)

        self._file = parquet.ParquetFile(path)
        self.schema = self._file.schema_arrow

    def column(self, name: str) -> Any:
        return self._file.read(columns=[name], use_threads=False).column(name)


def load_results(
    folder: Path,
    periods: Mapping[str, float],
    settings: Mapping[str, Any] | None = None,
    parameters: Mapping[str, Mapping[str, Value]] | None = None,
    stop: float | None = None,
) -> Results:
    """The results in a run's folder: the Parquet file, or what a killed run left in its stream, without a stop time."""
    if (folder / PARQUET).is_file():
        return Results(_Columns(folder / PARQUET), periods, settings, parameters, stop)
    if (folder / STREAM).is_file():
        table = read_stream(folder / STREAM)
        return Results(table, periods, settings, parameters, math.inf if stop is None else stop)
    raise CosimError(f"{folder} holds no results")
