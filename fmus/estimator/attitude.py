"""Roll and pitch of the body over the road, told by suspension travel and tyre compliance."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Signals
from fmus.estimator.navigation import where
from fmus.estimator.updating import OPEN, Estimate

_GRAVITY = 9.81  # m/s2
_LEAN, _SHARE = 0.7, 1.25
"""Standard deviations in terms of the largest values, which are 1 and 2.5 (engineering choice)."""


def quasi_static(travel: ca.SX, force: ca.SX, p: Signals) -> ca.SX:
    """(roll, pitch) over a flat road: suspension travel (4) [m] plus the tyres' share.

    phi = atan(mean over axles of (q_right - q_left)/d) + m h f_y / (c_z d^2)
    theta = atan((q_front - q_rear)/L) - m h f_x / (c_z L^2)
    The specific force `force` (2) contains the gravity of a tilted car, hence the overturning moment as well.
    """
    fl, fr, rl, rr = ca.vertsplit(travel)
    d, L, share = p["design.track"], p["design.wheelbase"], shares(p)
    roll = ca.atan((fr + rr - fl - rl) / (2 * d)) + share[0] * force[1]
    pitch = ca.atan((fl + fr - rl - rr) / (2 * L)) - share[1] * force[0]
    return ca.vertcat(roll, pitch)


def shares(p: Signals) -> ca.SX:
    """Roll and pitch from the tyres alone per specific force [rad/(m/s2)]: m h / (c_z d^2) and m h / (c_z L^2)."""
    return p["design.mass"] * p["design.cog_height"] / p["design.tyre_stiffness"] / _bases(p) ** 2


def load_spread(p: Signals) -> tuple[ca.SX, ca.SX]:
    """Standard deviations of what a load anywhere in the car makes wrong in the readings (2 each).

    Lean [rad]: over a wheel the load m' makes the tyres lean by g m' (d/2) / (c_z d^2). Share [rad/(m/s2)]: it raises
    m h by m' h', and it may lie 2.5 times as high as the centre of gravity.
    """
    load = p["design.payload"]
    lean = _LEAN * _GRAVITY * load / (2 * p["design.tyre_stiffness"] * _bases(p))
    return lean, _SHARE * shares(p) * load / p["design.mass"]


def weigh(estimate: Estimate, reading: ca.SX, force: ca.SX, variance: ca.SX) -> None:
    """Update with the reading z = tilt - o - s (f_y, -f_x) of variance [rad2]."""
    for axis, leverage in ((0, force[1]), (1, -force[0])):
        H = ca.SX(1, estimate.z.numel())
        H[0, where("tilt")[axis]], H[0, where("load_lean")[axis]] = 1, -1
        H[0, where("load_share")[axis]] = -leverage
        estimate.take(reading[axis] - H @ estimate.z, H, variance, gate=ca.SX(OPEN), used=ca.SX(1))


def _bases(p: Signals) -> ca.SX:
    """Track and wheelbase (2) [m]."""
    return ca.vertcat(p["design.track"], p["design.wheelbase"])
