"""When a message of the leader is another one: messages carry their age, no number."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

_SAME = 1e-3  # s; messages taken so close together are one


class News(NamedTuple):
    """Whether the message is new, and the time [s] by which it was sent after the one before, never zero."""

    new: ca.SX
    between: ca.SX


def news(heard: ca.SX, before: ca.SX, age: ca.SX, T: ca.SX) -> News:
    """Is the message of `age` [s] another than that which was `before` [s] old a period T [s] ago?

    A message that is held ages by T. Of what is shorter than that by less than half a sample, rounding may be the
    cause: a message at every sample is new at every sample, however short the period.
    """
    between, same = before + T - age, ca.fmin(_SAME, T / 2)
    return News(ca.logic_and(heard, between > same), ca.fmax(between, same))
