"""Reading the results of a run: columns as numpy arrays, units, and the rows at which an instance computed.

Of a Parquet file the columns are read when they are asked for, so that many vehicles need not fit into memory.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from cosim.errors import CosimError, unknown
from cosim.model.clock import SECOND
from cosim.model.face import Value
from cosim.model.signals import Vector
from cosim.results.growing import is_unfinished, open_unfinished
from cosim.results.storage import BEFORE, PARQUET, STREAM, open_parquet, read_stream


@dataclass(frozen=True, slots=True)
class Facts:
    """What is known of a run beside its signals.

    `periods` [s] by instance; `settings` of the scenario by name; `values` are those that parameters and inputs started
    with, by instance and variable; `stop` [s] is when the run was to end, None if its last row is that time.
    `absent` are signals that the system has without a user's FMU, and not with it: their columns are NaN.
    """

    periods: Mapping[str, float] = field(default_factory=dict)
    settings: Mapping[str, Any] = field(default_factory=dict)
    values: Mapping[str, Mapping[str, Value]] = field(default_factory=dict)
    stop: float | None = None
    absent: frozenset[str] = frozenset()


class Results:
    """The signals of a run: `results["plant.yaw"]` is a column; `facts` is what else is known of the run."""

    def __init__(self, table: Any, facts: Facts) -> None:
        self._table = table
        self.facts = facts
        self.names = [name for name in table.schema.names if name != "time"]
        self._known = frozenset(table.schema.names)
        self.time = table.column("time").to_numpy()

    @property
    def settings(self) -> Mapping[str, Any]:
        """The settings of the scenario that ran, by name."""
        return self.facts.settings

    def value(self, instance: str, variable: str) -> Value:
        """What a parameter or an input of `instance` started with; raises CosimError if that is not known."""
        values = self.facts.values.get(instance, {})
        if variable not in values:
            raise unknown(f"parameter of {instance}", variable, values)
        return values[variable]

    def number(self, instance: str, variable: str) -> float:
        """As `value`, of a parameter that is a number."""
        return float(self.value(instance, variable))

    def __contains__(self, name: str) -> bool:
        return name in self._known

    def __getitem__(self, name: str) -> Vector:
        if name in self.facts.absent:
            return np.full(len(self.time), np.nan)
        if name not in self:
            raise unknown("signal", name, self.names, "the columns of results.parquet are the signals")
        return np.asarray(self._table.column(name).to_numpy())

    def table(self, names: Sequence[str] | None = None) -> Any:
        """The time and all columns, or those named, as a pyarrow table; `.to_pandas()` of it is a data frame."""
        chosen = ["time", *(self.names if names is None else names)]
        schema = pa.schema([self._table.schema.field(name) for name in chosen])
        return pa.table([self._table.column(name) for name in chosen], schema=schema)

    def unit(self, name: str) -> str:
        """The unit of a column, or an empty string."""
        if name in self.facts.absent:
            return ""
        metadata = self._table.schema.field(name).metadata or {}
        return str(metadata.get(b"unit", b"").decode())

    def instants(self, instance: str) -> np.ndarray:
        """The recorded rows at which `instance` computed.

        That of the stop time is left out: the plants have arrived, but no sampled instance has run.
        """
        period = round(self.facts.periods[instance] * SECOND)
        nanoseconds = np.rint(self.time * SECOND).astype(np.int64)
        end = nanoseconds[-1:] if self.facts.stop is None else self.facts.stop * SECOND
        return np.flatnonzero((nanoseconds % period == 0) & (nanoseconds < np.rint(end)))

    def samples(self, instance: str, name: str) -> Vector:
        """The values of the variable `name` of `instance` at the rows at which it computed."""
        return np.asarray(self[f"{instance}.{name}"][self.instants(instance)])


class _Columns:
    """What `Results` needs of an Arrow table, out of an open Parquet file."""

    def __init__(self, file: Any) -> None:
        self._file = file
        self.rows = file.metadata.num_rows
        self.schema = file.schema_arrow

    def column(self, name: str) -> Any:
        return self._file.read(columns=[name], use_threads=False).column(name)


class _Joined:
    """What `Results` needs of an Arrow table, out of the two files of a killed run."""

    def __init__(self, early: _Columns, late: Any) -> None:
        self._early, self._late = early, late.slice(max(0, early.rows - _rows_before(late)))
        self.schema = early.schema

    def column(self, name: str) -> Any:
        return pa.chunked_array([*self._early.column(name).chunks, *self._late.column(name).chunks])


def _rows_before(stream: Any) -> int:
    return int((stream.schema.metadata or {}).get(BEFORE, b"0"))


def load_results(folder: Path, facts: Facts | None = None) -> Results:
    """The results in a run's folder: the Parquet file, or what a killed run left there, without a stop time.

    `facts` are what the caller knows of the run beside its signals. Raises CosimError for a folder without results.
    """
    facts = facts or Facts()
    if (folder / PARQUET).is_file():
        return Results(_Columns(open_parquet(folder / PARQUET)), facts)
    table = _left(folder)
    if table is not None:
        return Results(table, replace(facts, stop=math.inf if facts.stop is None else facts.stop))
    raise CosimError(f"{folder} holds no results")


def _left(folder: Path) -> Any:
    """What a killed run has left, None if nothing."""
    stream = _stream(folder / STREAM)
    if not is_unfinished(folder):
        return stream
    early = _Columns(open_unfinished(folder))
    return early if stream is None else _Joined(early, stream)


def _stream(path: Path) -> Any:
    """The table of a stream, None if there is none, or not even its first words."""
    try:
        return read_stream(path)
    except (FileNotFoundError, pa.ArrowInvalid):
        return None
