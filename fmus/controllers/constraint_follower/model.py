"""ConstraintFollower: from the leader's messages, the trajectory and the own estimate to commands."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Layout, Parts, Signals, named, sampled_kernel
from fmus.cars.rotation import rotation_plane
from fmus.clip import clip
from fmus.controllers.constraint_follower import commands, law, places
from fmus.controllers.constraint_follower.interface import INTERFACE, KINDS, ROWS
from fmus.controllers.formation import common, frame, leader, link, offset, realise
from fmus.controllers.formation.moving import MovingPlace

STATES = Layout(
    started=1,  # 0 before the first sample, which starts from the own motion
    speed=1,  # integrated speed [m/s]
    yaw_rate=1,  # integrated yaw rate [rad/s]
    command=2,  # speed [m/s] and yaw rate [rad/s] commanded last
    offset=offset.STATES,  # the wanted place on its way to formation.x/y
    headway=places.HEADWAY,
    path=places.PATH,
    link=link.STATES,
    leader=leader.STATES,
    frame=frame.STATES,
)


def kernel() -> Kernel:
    """The kernel; nothing is derived from the parameters."""
    return sampled_kernel(INTERFACE, states=STATES, initialise=initialise, sample=sample)


def initialise(p: Signals) -> tuple[Parts, Parts, Parts]:
    """Nothing is commanded before the first sample, but that no constraint is switched on is told."""
    return {}, {}, {"constraint.none": _none(p)}


def sample(p: Signals, u: Signals, x: Parts) -> tuple[Parts, Parts]:
    """Leader, place and trajectory as they move, the accelerations asked for, and the commands."""
    before = _begun(p, u, x)
    linked = link.supervise(p, u, before["link"], ca.fmax(u["leader.velocity.x"], 0))
    followed = leader.follow(p, u, before["leader"], linked.heard)
    integrals = commands.near(p, u, commands.Pair(before["speed"], before["yaw_rate"]))
    back, yielding = places.acceleration(p, before["headway"], integrals.speed)
    place = places.place(before["offset"], before["headway"], back)
    me = law.own(p, u, *integrals)
    ahead = leader.motion(p, followed)
    rod = frame.follow(p, u, before["frame"], ahead, place, linked.heard)
    axes = frame.motion(p, rod, ahead, place)
    asked = law.ask(p, me, ahead, place, places.path(p, u, before["path"]), axes, yielding, linked.heard)
    alone = ca.logic_and(linked.heard < 0.5, ca.sum1(asked.on) < 0.5)
    last = commands.Pair(before["command"][0], before["command"][1])
    driven = commands.command(p, u, asked, linked, alone, integrals, last)
    gained = (driven.integrals.speed - integrals.speed) / p["sample_period"]
    after = {
        "started": ca.SX(1),
        **driven.integrals._asdict(),
        "command": ca.vertcat(driven.speed.value, driven.yaw_rate.value),
        "offset": _shifting(p, u, before["offset"]),
        "headway": places.pulled_back(p, before["headway"], integrals.speed, gained),
        "path": places.path_state(p, u, before["path"]),
        "link": linked.state,
        "leader": followed,
        "frame": rod,
    }
    return after, _outputs(p, u, driven, asked, linked, place, followed)


def _begun(p: Signals, u: Signals, state: Parts) -> Parts:
    """The state, at the first sample that of a follower that drives as it does, wanted at formation.x/y."""
    own, most = ca.fmax(u["estimate.velocity.x"], 0), realise.yaw_rate_limit(p, u["estimate.velocity.x"])
    turning = clip(u["estimate.yaw_rate"], -most, most)
    start = {
        "speed": own,
        "yaw_rate": turning,
        "command": ca.vertcat(ca.fmin(own, p["limit.speed"]), turning),
        "offset": offset.start(common.wanted_place(u)),
        "headway": {"back": p["headway"] * own, "rate": 0},
        "path": places.path_start(u),
        "link": link.start(own),
    }
    return common.begun(state, start)


def _shifting(p: Signals, u: Signals, state: Parts) -> Parts:
    """The wanted place one sample later."""
    limits = p["transition.speed"], p["transition.acceleration"]
    duration = offset.unhurried(state, common.wanted_place(u), p["formation.duration"], *limits)
    return offset.advance(state, common.wanted_place(u), p["sample_period"], duration)


def _outputs(
    p: Signals,
    u: Signals,
    driven: commands.Commands,
    asked: law.Asked,
    linked: link.Link,
    place: MovingPlace,
    followed: Parts,
) -> Parts:
    rate = leader.rates(p, followed)
    values = {
        "command.yaw_acceleration": driven.yaw_rate.rate,
        "constraint.residual": ca.norm_2(asked.on * asked.multipliers.residual),
        "constraint.deficiency": ca.sum1(asked.on) - asked.rank,
        "constraint.none": _none(p),
        "leader.yaw_acceleration": rate[2],
    }
    z = rotation_plane(u["estimate.yaw"]).T @ law.error(p, asked)
    pairs = {"error": z, "offset": place.place, "leader.acceleration": rate[:2]}
    values |= common.outputs(p, u, driven.speed, driven.yaw_rate, linked.heard) | common.by_axis(pairs)
    return values | named("violation", ROWS, asked.on * asked.C) | named("multiplier", ROWS, asked.multipliers.value)


def _none(p: Signals) -> ca.SX:
    return 1 - ca.fmin(sum(p[f"constraint.{kind}"] for kind in KINDS), 1)
