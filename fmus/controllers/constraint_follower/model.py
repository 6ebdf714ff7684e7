"""ConstraintFollower: from the leader's messages, the trajectory and the own estimate to commands."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Layout, Signals, sampled_kernel, stack, symbols
from fmus.clip import clip
from fmus.controllers.constraint_follower import commands, law, leader, places
from fmus.controllers.constraint_follower.interface import INTERFACE, KINDS, ROWS
from fmus.controllers.formation import hand, link, offset, realise, sample

STATES = Layout(
    started=1,  # 0 before the first sample, which starts from the own motion
    speed=1,  # integrated speed [m/s]
    yaw_rate=1,  # integrated yaw rate [rad/s]
    command=2,  # speed [m/s] and yaw rate [rad/s] commanded last
    offset=offset.STATES.size,  # the wanted place on its way to formation.x/y
    headway=places.HEADWAY.size,
    path=places.PATH.size,
    link=link.STATES.size,
    leader=leader.STATES.size,
)
DERIVED = Layout()
Parts = dict[str, ca.SX]


def kernel() -> Kernel:
    """The kernel; nothing is derived from the parameters."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step())


def _initialise() -> ca.Function:
    p, u = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input")
    y = {name: ca.SX(0) for name in INTERFACE.names("output")} | {"constraint.none": _none(p)}
    arguments = [p.column, u.column, ca.SX.sym("w", 0), ca.SX.sym("table", 0), ca.SX.sym("rows")]
    x = ca.SX.zeros(STATES.size)
    return ca.Function("initialise", arguments, [ca.SX.zeros(0), x, stack(INTERFACE.names("output"), y)])


def _step() -> ca.Function:
    p, u, x = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), STATES.symbol()
    before = _begun(p, u, STATES.split(x))
    shift = _shifting(p, u, before["offset"])
    linked = link.supervise(p, u, before["link"], ca.fmax(u["leader.velocity.x"], 0))
    followed = leader.follow(p, u, before["leader"], linked.heard)
    integrals = commands.near(p, u, commands.Pair(before["speed"], before["yaw_rate"]))
    back, yielding = places.acceleration(p, before["headway"], integrals.speed)
    place = places.place(before["offset"], before["headway"], back)
    me = law.own(p, u, *integrals)
    others = leader.motion(p, followed), place, places.path(p, u, before["path"])
    asked = law.ask(p, me, *others, yielding, linked.heard)
    alone = ca.logic_and(linked.heard < 0.5, ca.sum1(asked.on) < 0.5)
    last = commands.Pair(*ca.vertsplit(before["command"]))
    driven = commands.command(p, u, asked, linked, alone, integrals, last)
    gained = (driven.integrals.speed - integrals.speed) / p["sample_period"]
    after = STATES.join(
        {"started": ca.SX(1), "command": ca.vertcat(driven.speed.value, driven.yaw_rate.value)}
        | driven.integrals._asdict()
        | {"offset": shift, "headway": places.pulled_back(p, before["headway"], integrals.speed, gained)}
        | {"path": places.path_state(p, u, before["path"]), "link": linked.state, "leader": followed}
    )
    y = stack(INTERFACE.names("output"), _outputs(p, u, driven, asked, linked, place, followed))
    arguments = [p.column, ca.SX.sym("d", 0), u.column, x, ca.SX.sym("w", 0), ca.SX.sym("t")]
    return ca.Function("step", arguments, [after, y])


def _begun(p: Signals, u: Signals, state: Parts) -> Parts:
    """The state, at the first sample that of a follower that drives as it does, wanted at formation.x/y."""
    own, most = ca.fmax(u["estimate.velocity.x"], 0), realise.yaw_rate_limit(p, u["estimate.velocity.x"])
    turning = clip(u["estimate.yaw_rate"], -most, most)
    start = {
        "speed": own,
        "yaw_rate": turning,
        "command": ca.vertcat(ca.fmin(own, p["limit.speed"]), turning),
        "offset": offset.start(sample.wanted_place(u)),
        "headway": ca.vertcat(p["headway"] * own, 0),
        "path": places.path_start(u),
        "link": link.start(own),
    }
    return sample.begun(state, start)


def _shifting(p: Signals, u: Signals, state: ca.SX) -> ca.SX:
    """The wanted place one sample later."""
    limits = p["transition.speed"], p["transition.acceleration"]
    duration = offset.unhurried(state, sample.wanted_place(u), p["formation.duration"], *limits)
    return offset.advance(state, sample.wanted_place(u), p["sample_period"], duration)


def _outputs(
    p: Signals,
    u: Signals,
    driven: commands.Commands,
    asked: law.Asked,
    linked: link.Link,
    place: leader.Motion,
    followed: ca.SX,
) -> Parts:
    rate = leader.rates(p, followed)
    values = {
        "command.yaw_acceleration": driven.yaw_rate.rate,
        "constraint.residual": ca.norm_2(asked.on * asked.multipliers.residual),
        "constraint.deficiency": ca.sum1(asked.on) - asked.rank,
        "constraint.none": _none(p),
        "leader.yaw_acceleration": rate[2],
    }
    z = hand.rotation(u["estimate.yaw"]).T @ law.error(p, asked)
    pairs = {"error": z, "offset": place.place, "leader.acceleration": rate[:2]}
    values |= sample.outputs(p, u, driven.speed, driven.yaw_rate, linked.heard) | sample.by_axis(pairs)
    values |= {f"violation.{row}": asked.on[i] * asked.C[i] for i, row in enumerate(ROWS)}
    return values | {f"multiplier.{row}": asked.multipliers.value[i] for i, row in enumerate(ROWS)}


def _none(p: Signals) -> ca.SX:
    return 1 - ca.fmin(sum(p[f"constraint.{kind}"] for kind in KINDS), 1)
