"""One tyre per axle that does what two tyres of the multibody car do in steady turns: a fit by least squares.

Load transfer costs the axles grip, and the pneumatic trail t loads the front axle with m a_y (l_R + t)/L, the rear one
with m a_y (l_F - t)/L; the fitted tyres carry m a_y l_R/L and m a_y l_F/L at the same slip angles.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from fmus.cars.assumed import AssumedCar
from fmus.cars.single_track import Tyre
from fmus.vehicle16dof import magic

MOST_SLIP = 0.12
"""Largest slip angle [rad] of the fit, about the limit of grip (engineering choice)."""
_SLIPS = np.linspace(0.004, MOST_SLIP, 30)
_SETTLED = 50
"""Iterations for load transfer and lateral acceleration to agree; each gains a digit."""

Array = NDArray[np.float64]


def axle_tyres(car: AssumedCar) -> tuple[Tyre, Tyre]:
    """The tyres of the front and of the rear axle."""
    front, rear = (_fitted(car.tyre, _SLIPS, _axle_forces(car, axle)) for axle in (0, 1))
    return front, rear


def _axle_forces(car: AssumedCar, axle: int) -> Array:
    """m a_y l_other/L [N] of the steady turn at each slip angle of `_SLIPS`, axle 0 in front, 1 behind."""
    arm, sign = ((car.l_r, 1), (car.l_f, -1))[axle]
    load, roll = 0.5 * (car.mass * car.gravity / car.wheelbase * arm), car.roll_stiffness[axle]
    stiffness = sum(car.roll_stiffness)
    # the rolled body overturns further
    height = car.cog_height / (1 - car.mass * car.gravity * car.cog_height / stiffness)
    transfer_per_force = height * roll / stiffness / car.track * car.wheelbase / arm
    found = []
    for tangent in np.tan(_SLIPS):
        force = 0.0
        for _ in range(_SETTLED):
            transfer = min(transfer_per_force * force, load)
            F_y, trail = _pair(car.tyre, (load - transfer, load + transfer), tangent)
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
