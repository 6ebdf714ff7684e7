"""The angle between where a car points and where it moves."""

from __future__ import annotations

from typing import Any

import casadi as ca


def sideslip(v: Any) -> Any:
    """atan2(v_y, v_x) [rad], positive to the left, of a velocity in body axes (2) [m/s].

    Faded to zero below 0.5 m/s, where its direction means nothing.
    """
    return ca.atan2(v[1], v[0]) * ca.fmin(ca.sumsqr(v) / 0.25, 1)
