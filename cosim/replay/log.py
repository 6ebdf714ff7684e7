"""Logs of measured columns: CSV files as loggers write them, and ASAM MDF 4."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np

from cosim.errors import CosimError, unknown
from cosim.model.signals import Vector
from cosim.replay.form import MapForm
from fmukit.errors import because


class Log:
    """Columns by name, of one length; what is no number in the file is NaN."""

    def __init__(self, file: Path, columns: dict[str, Vector]) -> None:
        self.file, self._columns = file, columns

    def __getitem__(self, name: str) -> Vector:
        if name not in self._columns:
            raise unknown(f"column of {self.file}", name, self._columns)
        return self._columns[name]


def read_log(file: Path, form: MapForm) -> Log:
    """The log, in the form that the map says; raises CosimError."""
    return _mdf(file, form.time.column) if file.suffix.lower() in (".mf4", ".mdf") else _csv(file, form)


def _csv(file: Path, form: MapForm) -> Log:
    try:
        with file.open(encoding="utf-8-sig", errors="replace", newline="") as opened:
            lines = list(csv.reader(opened, delimiter=form.separator))[form.skip :]
    except OSError as error:
        raise CosimError(f"{file} cannot be read: {because(error)}") from None
    except (csv.Error, TypeError) as error:
        raise CosimError(f"{file} is no table: {error}") from None
    names = [cell.strip(' #"') for cell in lines[0]] if lines else []
    rows = [row for row in lines[form.header_lines :] if any(cell.strip() for cell in row)]
    if not rows:
        raise CosimError(f"{file} has no rows after its names {','.join(names)[:80]}")
    table = np.array([[_number(row[k]) if k < len(row) else math.nan for k in range(len(names))] for row in rows])
    return Log(file, {name: table[:, k] for k, name in enumerate(names)})


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan


def _mdf(file: Path, time: str) -> Log:
    """All channels at the times of the one that is taken for the time, which may be the file's own, `time`."""
    try:
        from asammdf import MDF  # noqa: PLC0415 - an extra, for those who have such files
    except ImportError:
        raise CosimError("MDF needs the package asammdf: pip install 'vehicle-formation-fmus[mdf]'") from None
    try:
        with MDF(file) as measured:
            frame = measured.to_dataframe(time_from_zero=False)
    except OSError as error:
        raise CosimError(f"{file} cannot be read: {because(error)}") from None
    except Exception as error:  # whatever the library finds wrong in a file
        raise CosimError(f"{file} is no MDF: {' '.join(str(error).split())[:200]}") from None
    columns = {str(name): np.asarray(frame[name], float) for name in frame.columns if frame[name].dtype.kind in "fiub"}
    return Log(file, columns | ({time: np.asarray(frame.index, float)} if time not in columns else {}))
