"""Course lags yaw: errors and input reach in which the lagging car is again four integrators.

With a yaw rate answering dw as q' = (dw - q)/tau, and the sideslip of a car with controlled yaw rate answering as

    beta' = -a beta - (1 - a l_R'/v) q,   a = L C_R / (l_F' m v),

the lateral error obeys e_n' = v (e_psi + beta). In

    e_psi* = e_psi + tau q,   e_n* = e_n + (v/a) beta - tau reach q,   reach = v tau + v/a - l_R'

this is e_psi*' = dw, e_n*' = v e_psi* - reach dw, to first order exact also along a curve.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmukit.kernel import Signals
from fmus.controllers.high_level_lqr import leads


def reach(p: Signals, v: Any) -> Any:
    """reach [m] at speed v. Zero when the lag is not compensated."""
    lagging = leads.yaw_rate(p) * v + slide(p, v) - (p["design.l_r"] + p["design.pneumatic_trail"])
    return p["compensate_lag"] * lagging


def slide(p: Signals, v: Any) -> Any:
    """v/a [m]: how far the car slides sideways per sideslip angle that dies out."""
    l_F, l_R = p["design.l_f"] - p["design.pneumatic_trail"], p["design.l_r"] + p["design.pneumatic_trail"]
    return l_F * p["design.mass"] * v**2 / ((l_F + l_R) * p["design.cornering_rear"])


def undo(p: Signals, e: ca.SX, v: ca.SX, sideslip: ca.SX, q: ca.SX) -> ca.SX:
    """Errors (4) with e_n* and e_psi* in place of e_n and e_psi; sideslip [rad] beyond the expected, q [rad/s]."""
    tau, on = leads.yaw_rate(p), p["compensate_lag"]
    e_n = e[2] + on * (slide(p, v) * sideslip - tau * reach(p, v) * q)
    return ca.vertcat(e[0], e[1], e_n, e[3] + on * tau * q)


def answer(p: Signals, q: ca.SX, dw: ca.SX) -> ca.SX:
    """q after one sample of a held dw."""
    return dw + ca.exp(-p["sample_period"] / ca.fmax(leads.yaw_rate(p), 1e-3)) * (q - dw)
