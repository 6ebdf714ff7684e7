"""The reference of a sample: where on the bus it is read, and the car's motion on it over the horizon."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from fmukit.kernel import Parts, Signals, choose
from fmus.controllers.mpc_allocator import grip, horizon, memory, plan

_AHEAD = ca.DM([0.1 * k for k in range(31)])  # s: where bends are looked for
_STANDING = 0.01  # m/s: a reference this slow need not move
_OLDEST = 1e6  # s
_SPARE = 0.5  # s: so much is left of the memory behind the car when it is kept as it is


@dataclass(frozen=True, slots=True)
class Reference:
    """Nodes (9 x NODES + 1) and age [s] of the reference, 1 if the path at the car is `known`, 1 if the bus has gone
    too far ahead and is `lost`, and the states that belong to it.
    """

    nodes: ca.MX
    age: ca.MX
    known: ca.MX
    lost: ca.MX
    states: Parts


@dataclass(frozen=True, slots=True)
class _Kept:
    """What is kept of the bus: since when it has not moved, its sample then, the memory, and flags."""

    age: ca.MX
    bus: ca.MX
    past: ca.MX
    begun: ca.MX
    lost: ca.MX


def reference(p: Signals, u: Signals, x: Parts, usable: ca.MX, part: ca.MX) -> Reference:
    """The reference for inputs u and states x, on a road that gives a part of the friction once assumed."""
    Ts, gap = p["sample_period"], p["trajectory.gap"]
    bus = _kept(u, x, usable, Ts, gap)
    begun, lost, read = bus.begun, bus.lost, ca.fmin(bus.age, p["trajectory.timeout"])
    delay, e_s = begun * (x["delay"] + (1 - x["pace"]) * Ts), begun * x["errors"][0]
    delay = memory.delayed(delay, e_s, x["path_speed"], ca.if_else(ca.logic_or(lost, x["slow"]), 0, gap))
    delay, known = memory.within(delay, bus.past, read, x["path_speed"], plan.LENGTH)
    pace = memory.pace(delay, x["car"][2], x["path_speed"], lost, x["slow"])
    braking = lost * memory.braking(p["fallback.deceleration"], x["car"][2], x["path_speed"])
    end = ca.if_else(lost, bus.past[0, -1], memory.SEEN)
    slow, slowing = _slowed(p, u, x, (bus.past, read - delay, end), pace, part)
    braking = ca.fmax(braking, slowing)
    count = 2 * horizon.NODES + 1
    path = memory.along(u, bus.past, memory.Passage(read - delay, pace, braking, end), horizon.times(Ts))
    path, ahead = path[:, :count], path[:, count:]
    z = ca.if_else(begun, x["zero_dynamics"], horizon.steady(p, path[:, 0]))
    found = {
        "started": ca.MX(1),
        "past": ca.vec(bus.past),
        "lost": lost,
        "delay": delay,
        "pace": pace,
        "path_speed": path[3, 0] / pace,
        "path_acceleration": (path[4, 0] + path[3, 0] / pace * braking) / pace**2,
        "slow": slow,
        "zero_dynamics": horizon.later(p, z, path, ahead, Ts),
    }
    kept = choose(usable, found, x)
    states = kept | {"age": bus.age, "bus": bus.bus}
    return Reference(horizon.reference(p, z, path), bus.age, known, kept["lost"], states)


def _slowed(
    p: Signals, u: Signals, x: Parts, where: tuple[ca.MX, ca.MX, ca.MX], pace: ca.MX, part: ca.MX
) -> tuple[ca.MX, ca.MX]:
    """1 if the path is now followed without its times, and the loss of pace [1/s] that keeps to what the road bears."""
    past, start, end = where
    passage = memory.Passage(start, ca.MX(1), ca.MX(0), end)
    ahead = memory.along(u, past, passage, ca.MX(_AHEAD))
    bears = grip.allowed(p, part, x["car"][2], ahead)
    planned = x["path_acceleration"] * pace**2
    slow = (part < 1) * ca.logic_or(x["slow"], bears < planned)
    return slow, slow * ca.fmax(planned - bears, 0) / ca.fmax(x["path_speed"], 1)


def _kept(u: Signals, x: Parts, usable: ca.MX, Ts: ca.MX, gap: ca.MX) -> _Kept:
    """Time since the bus last moved, its sample then, and the memory of those before.

    The memory is kept as it is, and the bus is lost, when its next sample would take the place of one that the car
    has yet to pass. All begins anew when the bus is found near the car.
    """
    sample, elapsed = memory.now(u), ca.fmin(x["age"] + Ts, _OLDEST)
    found = x["lost"] * (ca.norm_2(sample[:2] - x["car"][:2]) <= gap)
    begun = x["started"] * (1 - found)
    same = ca.mmin(sample == x["bus"]) * (sample[3] > _STANDING) * begun
    moved = usable * (1 - same)
    past: Any = ca.reshape(x["past"], memory.ROW, memory.PAST)
    longer, dropped = memory.remembered(past, x["bus"], elapsed)
    passed = longer[0, 0] <= -x["delay"] - _SPARE
    lost = begun * ca.logic_or(x["lost"], moved * dropped * (1 - passed))
    after = ca.if_else(lost, memory.aged(past, elapsed), longer)
    after = ca.if_else(begun, after, memory.straight(sample))
    age, bus = ca.if_else(moved, 0, elapsed), ca.if_else(moved, sample, x["bus"])
    return _Kept(age, bus, ca.if_else(moved, after, past), begun, lost)
