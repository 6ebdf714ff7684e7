"""The published gear-shift car (mintOC, car testdrive), to validate the planner: the engine drives the rear axle.

U_F = -2/3 F_B, U_R = M_w/R - 1/3 F_B, omega_m = v i_g i_t/R, M_w = i_g i_t (f1 f2 + (1 - f1) f3),
f1 = 1 - exp(-3 phi), f2 = -37.8 + 1.54 omega_m - 0.0019 omega_m^2, f3 = -34.9 - 0.04775 omega_m.

The gear is relaxed: the wheel torque is the mean of the gears' torques with weights w_1..w_5 that sum to one. The
right-hand side is affine in the torque, so this is the outer convexification of the choice of gear.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from fmus.cars.single_track import SingleTrackCar
from fmus.planner.vehicle import Vehicle, two_wheel_drive
from fmus.single_track.forces import STATES
from fmus.single_track.model import derivative

FINAL_DRIVE = 3.91
GEARS = (3.91, 2.002, 1.33, 1.0, 0.805)
"""i_g; the first is 3.91: the misprint 3.09 gives final times that differ from the published ones by 0.06 s."""
INPUTS = ("omega_delta", "F_B", "phi", "w_2", "w_3", "w_4", "w_5")
"""Steering rate [rad/s], brake force [N], pedal 0..1, weights of the gears; w_1 = 1 - w_2 - ... - w_5."""


def wheel_torque(car: SingleTrackCar, v: ca.SX, phi: ca.SX, gear: float) -> ca.SX:
    """M_w [N.m] in one gear at pedal phi (mintOC, car testdrive)."""
    ratio = gear * FINAL_DRIVE
    omega = v * ratio / car.R
    f1 = 1 - ca.exp(-3 * phi)
    f2 = -37.8 + 1.54 * omega - 0.0019 * omega**2
    f3 = -34.9 - 0.04775 * omega
    return ratio * (f1 * f2 + (1 - f1) * f3)


def function(car: SingleTrackCar) -> ca.Function:
    """f(x, u) -> x_dot."""
    x, u = ca.SX.sym("x", len(STATES)), ca.SX.sym("u", len(INPUTS))
    weights = [1 - ca.sum1(u[3:]), *ca.vertsplit(u[3:])]
    M_w = sum(w * wheel_torque(car, x[2], u[2], gear) for w, gear in zip(weights, GEARS, strict=True))
    forces = ca.vertcat(u[0], -2 / 3 * u[1], M_w / car.R - u[1] / 3)
    x_dot = ca.cse(derivative(car, x, forces))
    return ca.Function("gear_shift", [x, u], [x_dot], ["x", "u"], ["x_dot"])


def gear_shift_car(car: SingleTrackCar) -> Vehicle:
    """The published car with five relaxed gears, for the planner."""
    x, u = ca.SX.sym("x", len(STATES)), ca.SX.sym("u", len(INPUTS))
    return replace(
        two_wheel_drive(car),
        name="gear_shift",
        f=function(car),
        input_lower=np.array([-0.5, 0, 0, 0, 0, 0, 0.0]),
        input_upper=np.array([0.5, 1.5e4, 1, 1, 1, 1, 1]),
        input_scale=np.array([0.5, 5e3, 1, 1, 1, 1, 1]),
        idle=np.array([0.0, 0, 0.9, 0.3, 0.3, 0.1, 0.1]),
        limits=ca.Function("limits", [x, u], [ca.sum1(u[3:]) - 1]),
        axle_forces=None,
    )
