"""CSV files that an FMU reads at initialisation, read by the FMU's own reader: what it would refuse is refused here."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cosim.errors import CosimError
from cosim.model.signals import Vector
from fmukit.interface import Interface
from fmukit.runtime.description import TableFile
from fmukit.runtime.table import TableError, read


def read_columns(file: str, interface: Interface) -> dict[str, Vector]:
    """The columns of `file` by name, read as the table of the FMU with this `interface`.

    Raises CosimError with file, row and remedy when the FMU could not read it.
    """
    table = interface.table
    assert table is not None
    try:
        spec = TableFile(0, table.columns, table.rows, table.increasing, tuple(table.names.items()))
        cells, count = read(file, spec, Path())
    except TableError as error:
        raise CosimError(str(error)) from None
    rows = np.reshape(cells, (-1, len(table.columns)))[:count]
    return dict(zip(table.columns, rows.T, strict=True))
