"""The columns of a chunk of rows: doubles as they are, other types made from them, Strings beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from cosim.model.signals import Signal

TYPES = {
    "Real": pa.float64(),
    "Integer": pa.int32(),
    "Enumeration": pa.int32(),
    "Boolean": pa.bool_(),
    "String": pa.string(),
}
"""How a variable of each FMI type is stored."""


class Texts(NamedTuple):
    """The String `signals` to be recorded, and the list their `values` are in."""

    signals: Sequence[Signal]
    values: Sequence[str]


class Batch:
    """The numbers of a chunk, `columns` (signals, rows), as Arrow sees them. Doubles alone are never copied."""

    def __init__(self, columns: Any, schema: Any) -> None:
        self._columns, self._schema = columns, schema
        self._plain = None
        if is_plain(schema):
            self._plain = pa.record_batch([pa.array(column) for column in columns], schema=schema)

    def first(self, rows: int, texts: Sequence[Sequence[str]]) -> Any:
        """The first rows; `texts` has the values of the String columns, row by row."""
        if self._plain is not None:
            return self._plain.slice(0, rows)
        numbers = [
            _typed(column[:rows], field.type) for column, field in zip(self._columns, self._schema, strict=False)
        ]
        count = len(self._schema) - len(numbers)
        words = [pa.array([row[i] for row in texts], pa.string()) for i in range(count)]
        return pa.record_batch([*numbers, *words], schema=self._schema)


def schema_of(signals: Sequence[Signal], about: Mapping[bytes, bytes] | None = None) -> Any:
    """The Arrow schema of the time and the signals, with their units; `about` is its metadata."""
    columns = [("time", "s", "Real"), *((signal.name, signal.unit, signal.type) for signal in signals)]
    return pa.schema(
        [pa.field(name, TYPES[type_], metadata={"unit": unit} if unit else None) for name, unit, type_ in columns],
        metadata=dict(about) if about else None,
    )


def is_plain(schema: Any) -> bool:
    """Whether all columns are doubles."""
    return all(pa.types.is_floating(type_) for type_ in schema.types)


def _typed(column: Any, type_: Any) -> Any:
    if pa.types.is_integer(type_):
        return pa.array(column.astype(np.int32))
    return pa.array(column != 0.0) if pa.types.is_boolean(type_) else pa.array(column)
