"""The numeric CSV file a component may read at initialisation."""

from __future__ import annotations

import csv
import os
from array import array
from itertools import pairwise
from math import isfinite
from pathlib import Path

from .description import TableFile


class TableError(Exception):
    """The file cannot be used; the message is a sentence naming file, line and remedy."""


def read(path: str, spec: TableFile, packed: Path) -> tuple[array[float], int]:
    """All rows one after the other, the last one repeated up to the capacity, and the number of rows.

    An empty path gives an empty table of zeros and 0 rows. A mere file name means first of all a file packed into the
    FMU, in its folder of resources `packed`, so that an FMU can bring its table along.
    """
    rows = _rows(_located(path, packed), spec) if path else []
    last = rows[-1] if rows else [0.0] * len(spec.columns)
    flat = array("d")
    for row in rows + [last] * (spec.rows - len(rows)):
        flat.extend(row)
    return flat, len(rows)


def _located(path: str, packed: Path) -> str:
    inside = os.path.join(packed, path)
    return inside if os.path.basename(path) == path and os.path.isfile(inside) else path


def _rows(path: str, spec: TableFile) -> list[list[float]]:
    try:
        if os.path.exists(path) and not os.path.isfile(path):
            raise OSError("it is not a file")  # a pipe or a device might never end
        with open(path, encoding="utf-8-sig", newline="") as file:
            lines = [line for line in csv.reader(file, skipinitialspace=True) if line]
    except OSError as error:
        raise TableError(
            f"table {path} cannot be read ({error.strerror or error}); give the path of a CSV file"
        ) from error
    except (ValueError, csv.Error) as error:
        raise TableError(
            f"table {path} cannot be read (it is not a text in UTF-8); give the path of a CSV file"
        ) from error
    order = _order(path, lines, spec)
    rows = [_numbers(path, number, line, spec) for number, line in enumerate(lines[1:], start=2)]
    rows = [[row[k] for k in order] for row in rows]
    for number, (before, after) in enumerate(pairwise(rows), start=3):
        if spec.increasing and not before[0] < after[0]:
            raise TableError(f"table {path}, row {number}: {spec.columns[0]} must increase from row to row")
    return rows


def _order(path: str, lines: list[list[str]], spec: TableFile) -> list[int]:
    """Where each column is in a line."""
    header = [cell.strip() for cell in lines[0]] if lines else []
    others = dict(spec.names)
    named = [others.get(cell, cell) for cell in (cell.lstrip("# ") for cell in header)]
    if sorted(named) != sorted(spec.columns):
        wanted = ",".join(spec.columns) + (f" or # {','.join(others)}" if others else "")
        raise TableError(f"table {path} must start with the line {wanted}, not {','.join(header) or 'empty'}")
    if not 2 <= len(lines) - 1 <= spec.rows:
        raise TableError(f"table {path} has {len(lines) - 1} rows; it must have 2 to {spec.rows}")
    return [named.index(name) for name in spec.columns]


def _numbers(path: str, number: int, line: list[str], spec: TableFile) -> list[float]:
    try:
        values = [float(cell) for cell in line]
    except ValueError:
        values = []
    if len(values) != len(spec.columns) or not all(map(isfinite, values)):
        raise TableError(
            f"table {path}, row {number}: expected {len(spec.columns)} finite numbers, got {','.join(line)}"
        )
    return values
