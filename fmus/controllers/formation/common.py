"""What a sample of every follower begins and ends with."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Parts, Signals, choose, named
from fmus.controllers.formation import realise


def begun(state: Parts, start: Parts) -> Parts:
    """The state, whose part `started` is 0 before the first sample: there the parts in `start` take its values."""
    return state | choose(state["started"], {name: state[name] for name in start}, start)


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


def by_axis(pairs: Parts) -> Parts:
    """Outputs name.x and name.y from vectors (2)."""
    return {name: value for group, pair in pairs.items() for name, value in named(group, "xy", pair).items()}
