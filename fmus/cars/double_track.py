"""Numbers of a car with four wheels that moves in the plane."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fmus.cars.single_track import SingleTrackCar, single_track_car


@dataclass(frozen=True, slots=True)
class DoubleTrackCar:
    """`planar` is the single-track car; half track d [m], height h [m], least wheel load [N]."""

    planar: SingleTrackCar
    d: float
    h: float
    least_load: float

    @property
    def wheel_positions(self) -> tuple[tuple[float, float], ...]:
        """(X_i, Y_i) [m] of fl, fr, rl, rr about the centre of gravity."""
        l_F, l_R = self.planar.l_F, self.planar.l_R
        return (l_F, self.d), (l_F, -self.d), (-l_R, self.d), (-l_R, -self.d)


def double_track_car(v: Any) -> DoubleTrackCar:
    """The car whose parameters by name are v[...], numbers or symbols; the names are those of both toml files here."""
    return DoubleTrackCar(
        single_track_car(v), d=v["geometry.half_track"], h=v["geometry.cog_height"], least_load=v["load.minimum"]
    )
