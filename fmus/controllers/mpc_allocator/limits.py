"""What the inputs may be now: from motors, friction, power and rates of the wheels to the two sides of the car."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca

from fmukit.kernel import Signals, block, slots
from fmus.cars.double_track import DoubleTrackCar
from fmus.clip import clip
from fmus.controllers.mpc_allocator.design_car import SLOWEST, design_car
from fmus.controllers.mpc_allocator.horizon import PERIOD
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.inversion import slip_for
from fmus.controllers.mpc_allocator.linearise import N_X
from fmus.double_track import distribution

_BEYOND = 1.4  # of the slip at 0.95 of the peak: about the slip of the peak itself
_FREE = 10.0  # rad


@block(p=slots(INTERFACE, "parameter"), x=N_X, a=2, available=4, U=4, command=1, part=1)
def limits(
    p: Signals, x: ca.SX, a: ca.SX, available: ca.SX, U: ca.SX, command: ca.SX, part: ca.SX
) -> tuple[ca.SX, ...]:
    """Low, high of u at once (3 x 2) and later (3 x 2), step of u per node (3), low, high of the wheels now (4 x 2).

    a          accelerations behind the wheel loads [m/s2]
    available  motors, 1 for a sound one
    U          forces of the wheels before [N]
    command    steering angle asked for before [rad]
    part       of the assumed friction: below 1 the front tyres are not steered far beyond their peak
    """
    motors, car, Ts = distribution.limits_of(p), design_car(p), p["sample_period"]
    slow = ca.vertcat(x[:2], ca.fmax(x[2], SLOWEST), x[3:])
    _, F_z, F_t = distribution.without_drive(car, slow, a)
    whole = distribution.bounds(motors, F_z, F_t, x[2], available=available)
    now = distribution.bounds(motors, F_z, F_t, x[2], available=available, previous=U, period=Ts)
    end, turn = p["actuator.steer_limit"], p["actuator.steer_rate"]
    useful = _useful(car, x, part < 1)
    reach = [clip(clip(command + sign * turn * Ts, *useful(1)), -end, end) for sign in (-1, 1)]
    ends = [clip(bound, -end, end) for bound in useful(2)]
    first = ca.horzcat(*(ca.vertcat(angle, sides(force)) for angle, force in zip(reach, now, strict=True)))
    later = ca.horzcat(*(ca.vertcat(angle, sides(force)) for angle, force in zip(ends, whole, strict=True)))
    step = PERIOD * ca.vertcat(turn, sides(motors.rate * available))
    return tuple(ca.cse([first, later, step, ca.horzcat(*now)]))


def _useful(car: DoubleTrackCar, x: ca.SX, slippery: ca.SX) -> Callable[[float], tuple[ca.SX, ca.SX]]:
    """Steering angles [rad] between which the slip of the front wheels is at most some times that of the peak."""
    v = ca.fmax(x[2], SLOWEST)
    direction = ca.atan2(v * ca.sin(x[3]) + car.planar.l_F * x[5], v * ca.cos(x[3]))
    slip = _BEYOND * slip_for(car.planar.front, ca.SX(1))

    def bounds(times: float) -> tuple[ca.SX, ca.SX]:
        low, high = (ca.if_else(slippery, direction + sign * times * slip, sign * _FREE) for sign in (-1, 1))
        return low, high

    return bounds


def sides(wheels: Any) -> Any:
    """Sum over the left and over the right wheels (2)."""
    return ca.vertcat(wheels[0] + wheels[2], wheels[1] + wheels[3])
