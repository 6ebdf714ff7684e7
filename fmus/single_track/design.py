"""The planar cars that stand for Vehicle16Dof: every number follows from its parameters.toml."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from fmukit.interface import load_parameters
from fmus import vehicle16dof
from fmus.cars.nominal import DESIGN, DesignModel
from fmus.single_track.data import Car, Tyre
from fmus.vehicle16dof import magic

_PARAMETERS = Path(vehicle16dof.__file__).with_name("parameters.toml")
_SLIPS = np.linspace(0.004, 0.12, 30)
"""Slip angles [rad] of the fit, up to about the limit of grip (engineering choice)."""
_SETTLED = 50
"""Iterations for load transfer and lateral acceleration to agree; each gains a digit."""

Array = NDArray[np.float64]


def design_car(design: DesignModel = DESIGN) -> Car:
    """The single-track car of a design model; each axle is fitted to two of the plant's tyres in a steady turn.

    Load transfer costs the axles grip, and the pneumatic trail t loads the front axle with m a_y (l_R + t)/L, the rear
    one with m a_y (l_F - t)/L; this car carries m a_y l_R/L and m a_y l_F/L at the same slip angles. Plan with it
    by `fmus.planner.vehicle.vehicle16dof`.
    """
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
    k = _tyre_data()
    front, rear = (_fitted(k, _SLIPS, _axle_forces(k, design, rough, axle)) for axle in (0, 1))
    return replace(rough, front=front, rear=rear)


def _tyre_data() -> dict[str, float]:
    values = {variable.name: float(variable.start) for variable in load_parameters(_PARAMETERS)}
    return {name.removeprefix("tyre."): value for name, value in values.items() if name.startswith("tyre.")}


def _axle_forces(k: Mapping[str, float], design: DesignModel, car: Car, axle: int) -> Array:
    """m a_y l_other/L [N] of the steady turn at each slip angle of `_SLIPS`, axle 0 in front, 1 behind."""
    load, roll = 0.5 * car.static_loads[axle], design.roll_stiffness[axle]
    stiffness = sum(design.roll_stiffness)
    # the rolled body overturns further
    height = design.cog_height / (1 - design.mass * design.gravity * design.cog_height / stiffness)
    arm, sign = ((car.l_R, 1), (car.l_F, -1))[axle]
    transfer_per_force = height * roll / stiffness / design.track * car.wheelbase / arm
    found = []
    for tangent in np.tan(_SLIPS):
        force = 0.0
        for _ in range(_SETTLED):
            transfer = min(transfer_per_force * force, load)
            F_y, trail = _pair(k, (load - transfer, load + transfer), tangent)
            force = F_y * arm / (arm + sign * trail)
        found.append(force)
    return np.array(found)


def _pair(k: Mapping[str, float], loads: tuple[float, float], tangent: float) -> tuple[float, float]:
    """Lateral force [N] and pneumatic trail [m] of the two tyres of an axle at one slip angle."""
    forces = [-magic.lateral(math, k, F_z, 1.0, tangent) for F_z in loads]
    fade = max(1 - tangent / k["trail_vanishing_slip"], 0)
    moment = sum(k["trail"] * fade * F_z / k["nominal_load"] * F_y for F_z, F_y in zip(loads, forces, strict=True))
    return sum(forces), moment / sum(forces)


def _fitted(k: Mapping[str, float], slips: Array, forces: Array) -> Tyre:
    """The factors B, D, E, at the plant's C, whose formula is nearest to the forces [N]."""
    C, peak = k["lateral.shape"], float(forces.max())

    def lack(found: Array) -> Array:
        B, D, E = found
        return np.asarray(D * magic.formula(_ArrayFunctions, B, C, E, slips) - forces / peak)

    B, D, E = least_squares(lack, [10.0, 1.0, 0.0], xtol=1e-12, ftol=1e-12, gtol=1e-12).x
    return Tyre(float(B), C, float(D) * peak, float(E))


class _ArrayFunctions:
    """Elementary functions of arrays under the names of `math`."""

    sin, atan = np.sin, np.arctan
