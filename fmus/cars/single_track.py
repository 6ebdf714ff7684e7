"""Numbers of a car with one wheel per axle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Tyre:
    """Factors of the magic formula of one axle; D in N, the others pure numbers."""

    B: float
    C: float
    D: float
    E: float


@dataclass(frozen=True, slots=True)
class SingleTrackCar:
    """SI units; the symbols are those of ../single_track/README.md. `drag` is c_w rho A / 2 [kg/m]."""

    m: float
    I_zz: float
    l_F: float
    l_R: float
    R: float
    g: float
    drag: float
    front: Tyre
    rear: Tyre
    rolling: tuple[float, float, float]

    @property
    def wheelbase(self) -> float:
        """L = l_F + l_R [m]."""
        return self.l_F + self.l_R

    @property
    def static_loads(self) -> tuple[float, float]:
        """F_zF, F_zR [N] of the axles."""
        per_metre = self.m * self.g / self.wheelbase
        return per_metre * self.l_R, per_metre * self.l_F


def single_track_car(v: Any) -> SingleTrackCar:
    """The car whose parameters by name are v[...], numbers or symbols; the names are those of single_track.toml."""
    return SingleTrackCar(
        m=v["body.mass"],
        I_zz=v["body.inertia.z"],
        l_F=v["geometry.front_axle"],
        l_R=v["geometry.rear_axle"],
        R=v["wheel.radius"],
        g=v["gravity"],
        drag=0.5 * v["body.drag_coefficient"] * v["air.density"] * v["body.frontal_area"],
        front=_tyre(v, "front"),
        rear=_tyre(v, "rear"),
        rolling=(v["rolling.constant"], v["rolling.linear"], v["rolling.quartic"]),
    )


def _tyre(v: Any, axle: str) -> Tyre:
    names = ("stiffness_factor", "shape_factor", "peak", "curvature_factor")
    return Tyre(*(v[f"tyre.{axle}.{name}"] for name in names))
