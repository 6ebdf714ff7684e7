"""Numbers of the double-track car."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fmukit.interface import load_parameters
from fmus.single_track import data
from fmus.single_track.data import Car

_PARAMETERS = Path(__file__).parent / "parameters.toml"


@dataclass(frozen=True, slots=True)
class DoubleTrackCar:
    """`planar` is the single-track car; half track d [m], height h [m], least wheel load [N]."""

    planar: Car
    d: float
    h: float
    least_load: float

    @property
    def wheel_positions(self) -> tuple[tuple[float, float], ...]:
        """(X_i, Y_i) [m] of fl, fr, rl, rr about the centre of gravity."""
        l_F, l_R = self.planar.l_F, self.planar.l_R
        return (l_F, self.d), (l_F, -self.d), (-l_R, self.d), (-l_R, -self.d)


def car(path: Path = _PARAMETERS, planar: Car | None = None) -> DoubleTrackCar:
    """The car of a parameter file, on the default single-track car unless `planar` is given."""
    return of({variable.name: float(variable.start) for variable in load_parameters(path)}, planar or data.car())


def of(v: Any, planar: Car) -> DoubleTrackCar:
    """The car on `planar` whose parameters by name are v[...], numbers or symbols."""
    return DoubleTrackCar(planar, d=v["geometry.half_track"], h=v["geometry.cog_height"], least_load=v["load.minimum"])
