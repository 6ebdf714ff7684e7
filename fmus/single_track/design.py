"""The planar cars that stand for Vehicle16Dof: every number follows from its parameters.toml."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from fmukit.interface import load_parameters
from fmus import vehicle16dof
from fmus.design import DESIGN, DesignModel
from fmus.single_track.data import Car, Tyre
from fmus.vehicle16dof import magic

_PARAMETERS = Path(vehicle16dof.__file__).with_name("parameters.toml")


def design_car(design: DesignModel = DESIGN) -> Car:
    """The single-track car of a design model; each axle is two of the plant's tyres at their static load."""
    no_tyre = Tyre(0.0, 0.0, 0.0, 0.0)
    rough = Car(
        m=design.mass,
        I_zz=design.yaw_inertia,
        l_F=design.l_f,
        l_R=design.l_r,
        R=design.loaded_radius,
        g=design.gravity,
        drag=0.5 * design.drag_area * design.air_density,
        front=no_tyre,
        rear=no_tyre,
        rolling=(design.rolling_constant, design.rolling_linear, design.rolling_quartic),
    )
    front, rear = (_axle(0.5 * load) for load in rough.static_loads)
    return replace(rough, front=front, rear=rear)


def _axle(F_z: float) -> Tyre:
    """Both tyres of an axle as one, each carrying F_z [N]: the plant's magic formula at that load."""
    values = {variable.name: float(variable.start) for variable in load_parameters(_PARAMETERS)}
    k = {name.removeprefix("tyre."): value for name, value in values.items() if name.startswith("tyre.")}
    df, C = magic.load_change(k, F_z), k["lateral.shape"]
    mu = k["lateral.friction"] + k["lateral.friction_load"] * df
    E = k["lateral.curvature"] + k["lateral.curvature_load"] * df
    return Tyre(magic.lateral_stiffness(k, F_z) / (C * mu), C, 2 * mu * F_z, E)
