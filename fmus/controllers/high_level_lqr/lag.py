"""Course lags yaw: errors and input reach in which the lagging car is again four integrators.

With a yaw rate answering dw as q' = (dw - q)/tau, and the sideslip of a car with controlled yaw rate answering as

    beta' = -a beta - (1 - a l_R'/v) q,   a = L C_R / (l_F' m v),

the lateral error obeys e_n' = v (e_psi + beta). In

    e_psi* = e_psi + tau q,   e_n* = e_n + (v/a) beta - tau reach q,   reach = v tau + v/a - l_R'

this is e_psi*' = dw, e_n*' = v e_psi* - reach dw, to first order exact also along a curve.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import casadi as ca

from fmus.controllers.high_level_lqr import leads

Expression = TypeVar("Expression", ca.SX, ca.MX)


def reach(get: Callable[[str], Expression], v: Expression) -> Expression:
    """reach [m] at speed v; `get` gives a parameter by name. Zero when the lag is not compensated."""
    lagging = leads.yaw_rate(get) * v + slide(get, v) - (get("design.l_r") + get("design.pneumatic_trail"))
    return get("compensate_lag") * lagging


def slide(get: Callable[[str], Expression], v: Expression) -> Expression:
    """v/a [m]: how far the car slides sideways per sideslip angle that dies out."""
    l_F, l_R = get("design.l_f") - get("design.pneumatic_trail"), get("design.l_r") + get("design.pneumatic_trail")
    return l_F * get("design.mass") * v**2 / ((l_F + l_R) * get("design.cornering_rear"))


def undo(get: Callable[[str], ca.SX], e: ca.SX, v: ca.SX, sideslip: ca.SX, q: ca.SX) -> ca.SX:
    """Errors (4) with e_n* and e_psi* in place of e_n and e_psi; sideslip [rad] beyond the expected, q [rad/s]."""
    tau, on = leads.yaw_rate(get), get("compensate_lag")
    e_n = e[2] + on * (slide(get, v) * sideslip - tau * reach(get, v) * q)
    return ca.vertcat(e[0], e[1], e_n, e[3] + on * tau * q)


def answer(get: Callable[[str], ca.SX], q: ca.SX, dw: ca.SX) -> ca.SX:
    """q after one sample of a held dw."""
    return dw + ca.exp(-get("sample_period") / ca.fmax(leads.yaw_rate(get), 1e-3)) * (q - dw)
