"""From the columns of a log to signals in SI units over the time of the replay."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cosim.errors import CosimError
from cosim.model.signals import Vector
from cosim.replay.form import ColumnForm, MapForm, PositionForm, VectorForm
from cosim.replay.log import Log

_MAJOR, _FLATTENING = 6378137.0, 1 / 298.257223563
"""Of WGS 84 (NIMA TR8350.2): half the major axis [m]."""


@dataclass(frozen=True, slots=True)
class Measured:
    """`values` in SI units at `times` [s] of the replay, which increase; without those that are no numbers."""

    times: Vector
    values: Vector


def time_of(log: Log, form: MapForm) -> Vector:
    """The time of each row [s], 0 where the replay begins; raises CosimError when it does not increase."""
    time = _scaled(log[form.time.column], form.time, log)
    known = time[np.isfinite(time)]
    if len(known) < 2 or (np.diff(known) < 0).any():
        raise CosimError(f"{log.file}: the time in {form.time.column} does not increase from row to row")
    return time - (known[0] if form.begin is None else form.begin)


def inputs(log: Log, form: MapForm, time: Vector) -> Iterator[tuple[str, Measured]]:
    """The inputs that the map names, with what they measure; raises CosimError."""
    for port, column in form.inputs.items():
        yield port, measured(log, column, time)
    for position in form.positions:
        yield from _local(log, position, time)
    for vector in form.vectors:
        yield from _turned(log, vector, time)


def measured(log: Log, form: ColumnForm, time: Vector) -> Measured:
    """One column."""
    return _cleaned(f"{log.file}: {form.column}", time + form.delay, _scaled(log[form.column], form, log))


def _cleaned(where: str, time: Vector, values: Vector) -> Measured:
    """Gaps are left out, and of rows at one time the last counts."""
    good = np.isfinite(time) & np.isfinite(values)
    time, values = time[good], values[good]
    last = np.append(np.diff(time) > 0, True) if len(time) else np.zeros(0, bool)
    if not last.any():
        raise CosimError(f"{where} holds no numbers")
    return Measured(time[last], values[last])


def _scaled(values: Vector, form: ColumnForm, log: Log) -> Vector:
    factor, offset = _si(form.unit, f"{log.file}: {form.column}") if form.unit else (1.0, 0.0)
    return (values * form.factor + form.offset) * factor + offset


def _si(unit: str, where: str) -> tuple[float, float]:
    """Factor and offset from a unit to the SI."""
    import pint  # noqa: PLC0415 - takes a third of a second, and only replays name units

    registry: Any = pint.UnitRegistry(autoconvert_offset_to_baseunit=True)
    try:
        zero, one = (registry.Quantity(value, unit).to_base_units().magnitude for value in (0.0, 1.0))
    except Exception:
        raise CosimError(
            f"{where}: unknown unit {unit!r}; give one such as deg/s, km/h, g_0, rpm, or a factor"
        ) from None
    return one - zero, zero


def _local(log: Log, form: PositionForm, time: Vector) -> Iterator[tuple[str, Measured]]:
    """East and north of the origin in the plane that touches the ellipsoid there."""
    latitude, longitude = np.radians(log[form.latitude]), np.radians(log[form.longitude])
    if form.origin is not None:
        origin = tuple(map(math.radians, form.origin))
    else:
        known = np.flatnonzero(np.isfinite(latitude) & np.isfinite(longitude))
        if not len(known):
            raise CosimError(f"{log.file}: {form.latitude} and {form.longitude} hold no numbers")
        origin = latitude[known[0]], longitude[known[0]]
    apart = _earth_centred(latitude, longitude) - _earth_centred(*map(np.array, origin))[..., None]
    east = np.array([-math.sin(origin[1]), math.cos(origin[1]), 0.0])
    up = np.array(
        [math.cos(origin[0]) * math.cos(origin[1]), math.cos(origin[0]) * math.sin(origin[1]), math.sin(origin[0])]
    )
    for port, axis in ((form.x, east), (form.y, np.cross(up, east))):
        yield port, _cleaned(f"{log.file}: {port}", time, axis @ apart)


def _earth_centred(latitude: Vector, longitude: Vector) -> Vector:
    """(3, n) [m] of points on the ellipsoid."""
    squared = _FLATTENING * (2 - _FLATTENING)
    bend = _MAJOR / np.sqrt(1 - squared * np.sin(latitude) ** 2)
    flat = bend * np.cos(latitude)
    return np.array([flat * np.cos(longitude), flat * np.sin(longitude), bend * (1 - squared) * np.sin(latitude)])


def _turned(log: Log, form: VectorForm, time: Vector) -> Iterator[tuple[str, Measured]]:
    """Components along the car's axes of what a turned sensor measures along its own."""
    own = np.array([_scaled(log[name], ColumnForm(name, form.unit), log) for name in form.columns])
    car = _rotation(*map(math.radians, (form.yaw, form.pitch, form.roll))) @ own
    for axis, values in zip("xyz", car, strict=True):
        yield f"{form.port}.{axis}", _cleaned(f"{log.file}: {form.port}", time, values)


def _rotation(yaw: float, pitch: float, roll: float) -> np.ndarray:
    """From the sensor's axes to the car's, ISO 8855: yaw about z, then pitch about y, then roll about x."""
    (cy, sy), (cp, sp), (cr, sr) = ((math.cos(a), math.sin(a)) for a in (yaw, pitch, roll))
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    return np.asarray(about_z @ about_y @ about_x)
