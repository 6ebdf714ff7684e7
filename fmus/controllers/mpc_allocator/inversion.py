"""Which motion of the car belongs to a path and a speed: sideslip, yaw rate, steering angle and force.

The car whose centre of gravity follows a path exactly keeps two states of its own, z = (beta, omega_z). With
chi = psi + beta the yaw rate is the course rate less the sideslip rate,

    beta' = v kappa - omega_z,   omega_z' = (l_F F_yF - l_R F_yR)/I_zz,
    F_yR = F_tR(alpha_R(z)),     F_yF = m (v^2 kappa cos beta + a sin beta) - F_yR,

and the front tyre, inverted, gives the steering angle. These zero dynamics are stable for a car that drives forward.
"""

from __future__ import annotations

import casadi as ca

from fmukit.integration import rk4
from fmus.cars.double_track import DoubleTrackCar
from fmus.cars.single_track import Tyre
from fmus.clip import clip
from fmus.controllers.mpc_allocator.design_car import SLOWEST, rate
from fmus.double_track.model import motion, wheel_loads

FULL = 0.95
"""Part of a tyre's peak up to which it is inverted (engineering choice): there the slope is still useful."""
_LARGEST = ca.DM([0.4, 3.0])  # rad, rad/s
_STEEPEST = 1.45  # rad: below pi/2, where the inverse of the magic formula ends


def slip_for(tyre: Tyre, part: ca.SX) -> ca.SX:
    """The slip angle [rad] at which the lateral force is `part` of the peak, within +- FULL.

    sin(C atan(phi)) = part with phi = s - E (s - atan s), s = B alpha; Newton's method from s = phi is monotone.
    """
    part = clip(part, -FULL, FULL)
    angle = ca.asin(part) / tyre.C
    phi = ca.tan(clip(angle, -_STEEPEST, _STEEPEST))
    s = phi
    for _ in range(5):
        s -= ((1 - tyre.E) * s + tyre.E * ca.atan(s) - phi) / (1 - tyre.E + tyre.E / (1 + s**2))
    return s / tyre.B


def steady(car: DoubleTrackCar, v: ca.SX, curvature: ca.SX) -> ca.SX:
    """The equilibrium z of the zero dynamics: each axle carries its share of m v^2 kappa."""
    p, v = car.planar, ca.fmax(v, SLOWEST)
    share = p.m * v**2 * curvature * p.l_F / p.wheelbase
    return ca.vertcat(p.l_R * curvature - slip_for(p.rear, share / p.rear.D), v * curvature)


def zero_dynamics(car: DoubleTrackCar, z: ca.SX, sample: ca.SX) -> ca.SX:
    """z' for sample = (v, a, kappa)."""
    p, v, curvature = car.planar, ca.fmax(sample[0], SLOWEST), sample[2]
    F_yF, F_yR = _axle_forces(car, z, sample)
    return ca.vertcat(v * curvature - z[1], (p.l_F * F_yF - p.l_R * F_yR) / p.I_zz)


def advance(car: DoubleTrackCar, z: ca.SX, samples: tuple[ca.SX, ca.SX, ca.SX], h: ca.SX | float) -> ca.SX:
    """z after h [s] by the classical Runge-Kutta method; the samples are at the beginning, middle and end."""
    at = dict(zip((0.0, 0.5, 1.0), samples, strict=True))
    after = rk4(lambda state, part: zero_dynamics(car, state, at[part]), z, h)
    return clip(after, -_LARGEST, _LARGEST)


def steering(car: DoubleTrackCar, z: ca.SX, sample: ca.SX) -> ca.SX:
    """delta [rad] that gives the front axle its force; two rounds for the turn of that force with the wheel."""
    p, v = car.planar, ca.fmax(sample[0], SLOWEST)
    F_yF, _ = _axle_forces(car, z, sample)
    loads = wheel_loads(car, *ca.vertsplit(_accelerations(sample)))
    peak = p.front.D * (loads[0] + loads[1]) / p.static_loads[0]
    direction = ca.atan2(v * ca.sin(z[0]) + p.l_F * z[1], v * ca.cos(z[0]))
    delta = direction
    for _ in range(2):
        delta = direction + slip_for(p.front, F_yF / (peak * ca.cos(delta)))
    return delta


def drive(car: DoubleTrackCar, lag: ca.SX, x: ca.SX, sample: ca.SX) -> ca.SX:
    """F_x [N] of the wheels that gives the car in state x (7) the acceleration along its path."""
    coasting = rate(car, lag, x, ca.vertcat(x[6], 0, 0), _accelerations(sample))
    return car.planar.m * (sample[1] - coasting[2]) / ca.cos(x[3])


def _accelerations(sample: ca.SX) -> ca.SX:
    return ca.vertcat(sample[1], sample[0] ** 2 * sample[2])


def _axle_forces(car: DoubleTrackCar, z: ca.SX, sample: ca.SX) -> tuple[ca.SX, ca.SX]:
    """F_yF wanted, F_yR found [N]."""
    v, a, curvature = ca.fmax(sample[0], SLOWEST), sample[1], sample[2]
    x = ca.vertcat(0, 0, v, z[0], 0, z[1], 0)
    found = motion(car, x, ca.SX.zeros(5), _accelerations(sample))
    F_yR = found.F_t[2] + found.F_t[3]
    F_y = car.planar.m * (v**2 * curvature * ca.cos(z[0]) + a * ca.sin(z[0]))
    return F_y - F_yR, F_yR
