"""Dry friction in a joint, with exact stick."""

from __future__ import annotations

import casadi as ca


def dry(capacity: ca.SX, load: ca.SX, momentum: ca.SX, stick_time: ca.SX) -> ca.SX:
    """Friction torque [N.m], at most `capacity`, against a joint loaded with `load` [N.m].

    It offers what brings the joint to rest within the stick time [s], as far as its capacity goes: sliding friction
    while the joint moves, exact hold at rest, and no reversal. `momentum` is inertia times joint rate [N.m.s].
    """
    return ca.fmax(ca.fmin(load + momentum / stick_time, capacity), -capacity)
