"""Results for other programs: CSV, MAT (level 5) and ASAM MDF 4."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa

from cosim.errors import CosimError
from cosim.results.reading import Results
from cosim.results.selection import rows, signals
from fmukit.errors import because

Writer = Callable[[Results, Sequence[str], np.ndarray, Path], None]


def convert(results: Results, file: Path, patterns: Sequence[str] = (), every: float = 0.0) -> Path:
    """Write signals that fit the patterns, a row every so many seconds, and return the file; raises CosimError.

    The suffix decides: .csv has a line of names; .mat has `names`, `units`, `time` (n,) and `values` (n, signals);
    .mf4 has a channel per signal with its unit.
    """
    writer = WRITERS.get(file.suffix.lower())
    if writer is None:
        raise CosimError(f"{file} has none of the suffixes {', '.join(WRITERS)}")
    names = [name for name in signals(results, patterns) if results[name].dtype.kind in "fiub"]
    chosen = rows(results.time, every)
    try:
        writer(results, names, chosen, file)
    except OSError as error:
        raise CosimError(f"{file} cannot be written: {because(error)}") from None
    return file


def _csv(results: Results, names: Sequence[str], chosen: np.ndarray, file: Path) -> None:
    from pyarrow import csv  # noqa: PLC0415 - each format has its own library, and a run needs none of them

    columns = {"time": results.time[chosen]} | {name: results[name][chosen] for name in names}
    csv.write_csv(pa.table(columns), file, csv.WriteOptions(quoting_style="needed"))


def _mat(results: Results, names: Sequence[str], chosen: np.ndarray, file: Path) -> None:
    from scipy.io import savemat  # noqa: PLC0415

    values = np.column_stack([results[name][chosen] for name in names]) if names else np.empty((len(chosen), 0))
    texts = {"names": np.array(names, dtype=object), "units": np.array([*map(results.unit, names)], dtype=object)}
    savemat(file, {**texts, "time": results.time[chosen], "values": values}, do_compression=True, oned_as="column")


def _mf4(results: Results, names: Sequence[str], chosen: np.ndarray, file: Path) -> None:
    try:
        from asammdf import MDF, Signal  # noqa: PLC0415
    except ImportError:
        raise CosimError("MDF needs the package asammdf: pip install 'vehicle-formation-fmus[mdf]'") from None
    time = results.time[chosen]
    channels = [Signal(results[name][chosen], time, unit=results.unit(name), name=name) for name in names]
    with MDF(version="4.10") as measured:
        measured.append(channels, comment="cosim", common_timebase=True)
        measured.save(file, overwrite=True)


WRITERS: dict[str, Writer] = {".csv": _csv, ".mat": _mat, ".mf4": _mf4}
"""By suffix."""
