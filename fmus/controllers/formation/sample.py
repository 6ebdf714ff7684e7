"""What a sample of every follower begins and ends with."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from fmukit.kernel import Signals
from fmus.controllers.formation import realise

Parts = dict[str, ca.SX]


def begun(state: Mapping[str, ca.SX], start: Mapping[str, ca.SX]) -> Parts:
    """The state, whose part `started` is 0 before the first sample: there the parts in `start` take its values."""
    return {**state, **{name: ca.if_else(state["started"], state[name], value) for name, value in start.items()}}


def wanted_place(u: Signals) -> ca.SX:
    """(formation.x, formation.y) [m] (2)."""
    return u.vector("formation", "xy")


def outputs(p: Signals, u: Signals, speed: realise.Realised, yaw_rate: realise.Realised, heard: ca.SX) -> Parts:
    """The outputs of every follower by name, but for error.* and offset.*."""
    return {
        "command.speed": speed.value,
        "command.acceleration": speed.rate,
        "command.yaw_rate": yaw_rate.value,
        "command.steer_feedforward": realise.steering(p, u["estimate.velocity.x"], yaw_rate.value),
        "saturation.speed": speed.limited,
        "saturation.yaw_rate": yaw_rate.limited,
        "link.lost": 1 - heard,
    }


def by_axis(pairs: Mapping[str, ca.SX]) -> Parts:
    """Outputs name.x and name.y from vectors (2)."""
    return {f"{name}.{axis}": pair[i] for name, pair in pairs.items() for i, axis in enumerate("xy")}
