"""The reference of a sample: where on the bus it is read, and the car's motion on it over the horizon."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmus.controllers.mpc_allocator import horizon, memory
from fmus.controllers.mpc_allocator.programs import parameter

_STANDING = 0.01  # m/s: a reference this slow need not move
_OLDEST = 1e6  # s


@dataclass(frozen=True, slots=True)
class Reference:
    """Nodes (9 x NODES + 1) and age [s] of the reference, and the states that belong to it."""

    nodes: ca.MX
    age: ca.MX
    states: dict[str, ca.MX]


def reference(p: ca.MX, u: ca.MX, x: dict[str, ca.MX], usable: ca.MX) -> Reference:
    """The reference for inputs u and states x."""
    Ts, timeout, gap = (parameter(p)(f) for f in ("sample_period", "trajectory.timeout", "trajectory.gap"))
    age, seen, past = _kept(u, x, usable, Ts)
    delay = memory.delayed(x["delay"] + (1 - x["pace"]) * Ts, x["gap"], x["path_speed"], gap)
    pace = memory.pace(delay, x["car"][2], x["path_speed"])
    count = 2 * horizon.NODES + 1
    path = memory.along(u, past, ca.fmin(age, timeout) - delay, pace, horizon.times(Ts))
    path, ahead = path[:, :count], path[:, count:]
    z = ca.if_else(x["started"], x["zero_dynamics"], horizon.steady(p, path))
    found = {
        "started": ca.MX(1),
        "past": ca.vec(past),
        "delay": delay,
        "pace": pace,
        "path_speed": path[3, 0] / pace,
        "zero_dynamics": horizon.later(p, z, path, ahead, Ts),
    }
    kept = {name: ca.if_else(usable, value, x[name]) for name, value in found.items()}
    return Reference(horizon.reference(p, z, path), age, kept | {"age": age, "bus": seen})


def _kept(u: ca.MX, x: dict[str, ca.MX], usable: ca.MX, Ts: ca.MX) -> tuple[ca.MX, ca.MX, ca.MX]:
    """Time since the bus last moved [s], its sample then, and the memory of those before."""
    sample, elapsed = memory.now(u), ca.fmin(x["age"] + Ts, _OLDEST)
    same = ca.mmin(sample == x["bus"]) * (sample[3] > _STANDING) * x["started"]
    moved = usable * (1 - same)
    past = ca.reshape(x["past"], memory.ROW, memory.PAST)
    longer = ca.if_else(x["started"], memory.remembered(past, x["bus"], elapsed), memory.straight(sample, Ts))
    return ca.if_else(moved, 0, elapsed), ca.if_else(moved, sample, x["bus"]), ca.if_else(moved, longer, past)
