"""The form of a map from the columns of a log to ports; docs/replay.md describes it."""

from __future__ import annotations

import msgspec

from cosim.system_file.form import Scalar


class ColumnForm(msgspec.Struct, forbid_unknown_fields=True):
    """A column in a `unit` of the pint library, or times `factor` plus `offset`; a `delay` [s] makes it later."""

    column: str
    unit: str | None = None
    factor: float = 1.0
    offset: float = 0.0
    delay: float = 0.0


class PositionForm(msgspec.Struct, forbid_unknown_fields=True):
    """Columns of WGS 84 latitude and longitude [deg] that become x (east) and y (north) [m] of two inputs.

    Without an `origin` (latitude, longitude) [deg] the first row with both is it.
    """

    latitude: str
    longitude: str
    x: str
    y: str
    origin: tuple[float, float] | None = None


class VectorForm(msgspec.Struct, forbid_unknown_fields=True):
    """Three columns of a sensor that is mounted turned: by yaw, then pitch, then roll [deg] from the car's axes.

    The inputs are `port` with .x, .y and .z after it.
    """

    port: str
    columns: tuple[str, str, str]
    unit: str | None = None
    yaw: float = 0.0
    pitch: float = 0.0
    roll: float = 0.0


class MapForm(msgspec.Struct, forbid_unknown_fields=True):
    """A `system` file, or one `model` whose instance has the name of the model in small letters.

    `time` is a column; the replay begins at its first value, or at `begin` [s] of the log, and lasts to its last, or
    for `duration` [s]. `skip` lines stand before that of the names, `header_lines` are those with names and below them.
    """

    time: ColumnForm
    inputs: dict[str, ColumnForm] = {}
    compare: dict[str, ColumnForm] = {}
    positions: list[PositionForm] = []
    vectors: list[VectorForm] = []
    system: str = ""
    model: str = ""
    parameters: dict[str, Scalar] = {}
    period: float | None = None
    begin: float | None = None
    duration: float | None = None
    skip: int = 0
    header_lines: int = 1
    separator: str = ","
    longest_lag: float = 0.5
