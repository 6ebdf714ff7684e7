"""The friction of the road as a part of that assumed, from what the car does; and the speed that it bears.

Peaks D of the tyres become mu D and factors B become B/mu, which keeps the slip stiffness: mu shows only near the peak.
It is a random walk, learnt by a Kalman filter from what the model missed of sideslip rate and yaw acceleration,

    mu <- mu + K m,   K = P S'/(1 + P S S'),   S = d(beta', omega_z')/d mu,   P' = q,

m and S in units of the noise of m. Until mu has fallen below `_SURE` the tyres are those assumed.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals, block, slots
from fmus.clip import clip
from fmus.controllers.mpc_allocator.design_car import SLOWEST, design_car, wheel_rate
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_X

STATES = Layout(friction=1, variance=1)
_PEAKS = ("design.tyre.front.peak", "design.tyre.rear.peak", "limit.friction")
_FACTORS = ("design.tyre.front.stiffness_factor", "design.tyre.rear.stiffness_factor")
_SURE, _STEEP = 0.9, 1.5
_LEAST = 0.1
_NEAR = 2.0  # m


def applied(p: Signals, friction: ca.MX) -> ca.MX:
    """The part of the assumed friction that is counted on: 1 down to `_SURE`, then the estimate, without a jump."""
    counted = ca.fmin(1, ca.fmax(friction, 1 - _STEEP * (_SURE - friction)))
    return ca.if_else(p["grip.enabled"], counted, 1)


def adapted(p: Signals, part: ca.MX) -> Signals:
    """The parameters with tyres and friction of a road that gives a part of the assumed friction."""
    names = INTERFACE.names("parameter")
    factor = [part if n in _PEAKS else 1 / part if n in _FACTORS else ca.MX(1) for n in names]
    return p.over(p.column * ca.vertcat(*factor))


@block(p=slots(INTERFACE, "parameter"), x=N_X, U=4, a=2, missed=2, part=1, before=STATES, learning=1)
def learnt(
    p: Signals, x: ca.SX, U: ca.SX, a: ca.SX, missed: ca.SX, part: ca.SX, before: Parts, learning: ca.SX
) -> Parts:
    """The states after the model, on a road of the part counted on, has missed (beta', omega_z') (2) [rad/s, rad/s2].

    x (7), wheel forces U (4) [N] and accelerations a (2) [m/s2] are those at the sample before.
    """
    mu: Any = ca.SX.sym("mu")
    car = design_car(p)
    front, rear = (replace(t, B=t.B / mu, D=t.D * mu) for t in (car.planar.front, car.planar.rear))
    worn = replace(car, planar=replace(car.planar, front=front, rear=rear))
    noise = ca.vertcat(p["grip.sideslip_noise"], p["grip.yaw_noise"])
    slope = ca.jacobian(wheel_rate(worn, x, U, a)[0][[3, 5]] / noise, mu)
    S = ca.substitute(slope, mu, part)
    variance = ca.fmin(before["variance"] + p["grip.walk"] ** 2 * p["sample_period"], p["grip.spread"] ** 2)
    shrink = 1 + variance * ca.sumsqr(S)
    change = variance * ca.dot(S, missed / noise) / shrink
    moving = learning * (x[2] > SLOWEST)
    friction = clip(before["friction"] + moving * change, _LEAST, 1)
    return {"friction": friction, "variance": ca.if_else(moving, variance / shrink, before["variance"])}


def allowed(p: Signals, part: ca.MX, v: ca.MX, ahead: ca.MX) -> ca.MX:
    """Largest acceleration [m/s2] now, constant, at which the speed v [m/s] stays what the bends `ahead` (6 x n) bear.

    A bend of curvature kappa bears v^2 kappa = `grip.use` times the largest lateral acceleration of the axles.
    """
    car = design_car(p).planar
    front, rear = car.front.D / car.l_R, car.rear.D / car.l_F
    largest = p["grip.use"] * ca.fmin(front, rear) * car.wheelbase / car.m
    steps = ca.sqrt(ca.sum1((ahead[:2, 1:] - ahead[:2, :-1]) ** 2))
    way = ca.horzcat(0, ca.cumsum(steps, 1))
    bears = largest / ca.fmax(ca.fabs(ahead[5, :]), 1e-6)
    least = ca.mmin((bears - v**2) / (2 * ca.fmax(way, _NEAR)))
    return ca.fmax(least, -p["grip.deceleration"] * part)
