"""Numbers of the single-track car, from parameters.toml."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fmukit.interface import load_parameters

_PARAMETERS = Path(__file__).parent / "parameters.toml"


@dataclass(frozen=True, slots=True)
class Tyre:
    """Factors of the magic formula of one axle; D in N, the others pure numbers."""

    B: float
    C: float
    D: float
    E: float

    @property
    def cornering_stiffness(self) -> float:
        """Slope BCD [N/rad] at zero slip."""
        return self.B * self.C * self.D


@dataclass(frozen=True, slots=True)
class Car:
    """SI units; the symbols are those of README.md."""

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

    @property
    def understeer_gradient(self) -> float:
        """m (l_R/C_F - l_F/C_R)/L [rad/(m/s2)], from the cornering stiffnesses."""
        parts = self.l_R / self.front.cornering_stiffness - self.l_F / self.rear.cornering_stiffness
        return self.m * parts / self.wheelbase


def car(path: Path = _PARAMETERS) -> Car:
    """The car of a parameter file."""
    return of({variable.name: float(variable.start) for variable in load_parameters(path)})


def of(v: Any) -> Car:
    """The car whose parameters by name are v[...], numbers or symbols; `drag` is c_w rho A / 2 [kg/m]."""
    return Car(
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
