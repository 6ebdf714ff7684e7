"""Active suspension: heave, roll and pitch from triple pole error equations, shared among four actuators."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Signals
from fmus.clip import clip
from fmus.controllers.low_level_pid.error_ode import triple_pole


def sharing(p: Signals) -> ca.SX:
    """T+ (4 x 3), the pseudo-inverse of T = [1; y_i; -x_i]: least corner forces for (heave force, roll, pitch moment).

    T' is also the kinematics: height of corner i = z + y_i roll - x_i pitch.
    """
    x = ca.vertcat(p["design.l_f"], p["design.l_f"], -p["design.l_r"], -p["design.l_r"])
    y = p["design.track"] / 2 * ca.DM([1, -1, 1, -1])
    T = ca.horzcat(ca.SX.ones(4), y, -x).T
    return T.T @ ca.inv(T @ T.T)


def forces(p: Signals, T_plus: ca.SX, error: ca.SX, rate: ca.SX, integral: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Limited corner forces (4) [N], next integrals (3) and saturation 0/1 from errors of (heave, roll, pitch) (3).

    W = diag(m_s, I_x, I_y) (3 lambda e' + 3 lambda^2 e + lambda^3 int e), f = T+ W; the springs and dampers stay.
    """
    inertia = ca.vertcat(p["design.sprung_mass"], p["design.roll_inertia"], p["design.pitch_inertia"])
    wrench = inertia * triple_pole(p["suspension.pole"], rate, error, integral)
    demanded = p["suspension.enabled"] * (T_plus @ wrench)
    largest = p["suspension.force_limit"]
    force = clip(demanded, -largest, largest)
    saturated = ca.mmax(force != demanded)
    return force, integral + p["sample_period"] * error * (1 - saturated), saturated
