"""Feed-forward: stable inversion of the linear single-track vehicle for a given path and speed."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import casadi as ca

from fmukit.integration import rk4
from fmukit.kernel import Signals

NODES = 5
_SLOWEST = 3.0  # m/s; the zero dynamics become ever faster towards standstill

Ahead = Callable[[ca.SX], ca.SX]


class NearFuture(NamedTuple):
    """The near future of the reference: speed [m/s] and curvature [1/m] as functions of the time ahead [s]."""

    speed: Ahead
    curvature: Ahead


def polynomial(nodes: ca.SX, period: float) -> Ahead:
    """The polynomial through equidistant samples nodes (n) at 0, period, ...: time ahead [s] -> value."""
    n = nodes.numel()
    powers = ca.inv(ca.DM([[float(i) ** j for j in range(n)] for i in range(n)]))
    coefficients = powers @ nodes

    def value(time: ca.SX) -> ca.SX:
        total = ca.SX(0)
        for j in reversed(range(n)):
            total = coefficients[j] + time / period * total
        return total

    return value


def zero_dynamics(p: Signals, z: ca.SX, v: ca.SX, curvature: ca.SX) -> ca.SX:
    """z' of z = (beta, r) when the path is followed exactly (a_y = v^2 kappa).

    F_R = -C_R (beta - l_R' r/v); F_F = m a_y - F_R; I_zz r' = l_F' F_F - l_R' F_R; beta' = a_y/v - r.
    """
    l_F, l_R = _arms(p)
    F_R = rear_force(p, z, v)
    F_F = p["design.mass"] * v**2 * curvature - F_R
    return ca.vertcat(v * curvature - z[1], (l_F * F_F - l_R * F_R) / p["design.yaw_inertia"])


def rear_force(p: Signals, z: ca.SX, v: ca.SX) -> ca.SX:
    """Lateral force of the rear axle [N] at z = (beta, r)."""
    return -p["design.cornering_rear"] * (z[0] - _arms(p)[1] * z[1] / ca.fmax(v, _SLOWEST))


def steady(p: Signals, v: ca.SX, curvature: ca.SX) -> ca.SX:
    """The equilibrium (beta, r) of the zero dynamics: r = v kappa, both axles carry their share of m a_y."""
    l_F, l_R = _arms(p)
    r = v * curvature
    F_R = p["design.mass"] * v**2 * curvature * l_F / (l_F + l_R)
    return ca.vertcat(l_R * r / ca.fmax(v, _SLOWEST) - F_R / p["design.cornering_rear"], r)


def propagate(p: Signals, z: ca.SX, path: NearFuture, duration: ca.SX, substeps: int) -> ca.SX:
    """z after `duration` [s] from now, by the classical Runge-Kutta method."""
    h = duration / substeps
    for k in range(substeps):
        start = k * h

        def rate(state: ca.SX, part: float, start: ca.SX = start) -> ca.SX:
            time = start + part * h
            return zero_dynamics(p, state, path.speed(time), path.curvature(time))

        z = rk4(rate, z, h)
    return z


def steering(p: Signals, z: ca.SX, path: NearFuture, time: ca.SX) -> ca.SX:
    """delta_ff [rad] at `time` ahead, where the zero dynamics are at z.

    delta_ff = F_F/C_F + beta + l_F' r/v + sigma/v F_F'/C_F; the last term makes up for the tyre's relaxation.
    """
    v, curvature = path
    now = ca.SX.sym("now")
    force = p["design.mass"] * v(now) ** 2 * curvature(now)
    total, total_rate = (ca.substitute(f, now, time) for f in (force, ca.jacobian(force, now)))
    speed = ca.fmax(v(time), _SLOWEST)
    z_rate = zero_dynamics(p, z, v(time), curvature(time))
    F_F = total - rear_force(p, z, v(time))
    F_F_rate = total_rate - rear_force(p, z_rate, v(time))
    relaxed = F_F + p["design.relaxation_length"] / speed * F_F_rate
    return relaxed / p["design.cornering_front"] + z[0] + _arms(p)[0] * z[1] / speed


def _arms(p: Signals) -> tuple[ca.SX, ca.SX]:
    """Distances l_F', l_R' of the axle forces, moved back by the pneumatic trail."""
    trail = p["design.pneumatic_trail"]
    return p["design.l_f"] - trail, p["design.l_r"] + trail
