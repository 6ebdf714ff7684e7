"""AdaptiveFollower: from the leader's pose and the own estimate to commands, and the weights one sample on."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from fmukit.kernel import Kernel, Layout, Parts, Signals, choose, sampled_kernel
from fmus.clip import clip
from fmus.controllers.adaptive_follower import broadcast, law, network, situation, turning
from fmus.controllers.adaptive_follower.interface import INTERFACE
from fmus.controllers.formation import common, frame, leader, link, offset, realise

_V, _W = (network.N1 + 1, network.N2), (network.N2 + 1, network.N3)
STATES = Layout(
    started=1,  # 0 before the first sample, which starts from the own motion
    V=_V[0] * _V[1],  # hidden weights, column by column
    W=_W[0] * _W[1],  # output weights, column by column [m/s]
    velocity=2,  # nu_hat at the last sample [m/s]
    speed=1,  # command.speed at the last sample [m/s]
    yaw_rate=1,  # command.yaw_rate at the last sample [rad/s]
    offset=offset.STATES,  # the wanted place on its way to formation.x/y
    link=link.STATES,  # how long the leader has been lost, and its last known speed
    turning=turning.STATES,  # the leader's yaw rate from its messages
    broadcast=broadcast.STATES,  # the speed told by the head of the formation
    leader=leader.STATES,  # how the leader moves, from what is heard
    frame=frame.STATES,  # the rod that trails from its hand
)
_LEARNING = (
    *("adaptation.output", "adaptation.hidden", "leak.output", "leak.hidden", "leak.exponent"),
    "adaptation.fastest",
)


def kernel() -> Kernel:
    """The kernel; the states hold all weights."""
    return sampled_kernel(INTERFACE, states=STATES, initialise=initialise, sample=sample)


class _Driven(NamedTuple):
    """nu_hat and the commands it leads to."""

    nu: ca.SX
    speed: realise.Realised
    yaw_rate: realise.Realised


def initialise(p: Signals) -> tuple[Parts, Parts, Parts]:
    """Hidden weights as drawn; nothing is commanded before the first sample, but a bad choice of gains is told."""
    return {}, {"V": ca.vec(network.first_hidden_weights())}, {"gain_rule.broken": _rule_broken(p)}


def sample(p: Signals, u: Signals, x: Parts) -> tuple[Parts, Parts]:
    """What is known of the leader, the weights learnt from it, and the commands they lead to."""
    before = situation.told(p, u, _begun(p, u, x))
    linked = link.supervise(p, u, before["link"], ca.fmax(situation.leader_speed(p, before), 0))
    before |= {"turning": turning.follow(p, u, before["turning"], linked.heard)}
    before |= {"leader": leader.follow(p, u, before["leader"], linked.heard)}
    before |= {"frame": situation.towed(p, u, before, linked)}
    before |= {"offset": situation.led_back(p, u, before, linked)}
    seen = situation.seen(p, u, before)
    taught = before | _taught(p, u, before, seen, linked)
    driven = _drive(p, u, taught, seen, linked)
    after = {
        "started": ca.SX(1),
        "V": ca.vec(taught["V"]),
        "W": ca.vec(taught["W"]),
        "velocity": driven.nu,
        "speed": driven.speed.value,
        "yaw_rate": driven.yaw_rate.value,
        "offset": situation.shifted(p, u, before),
        "link": linked.state,
        "turning": before["turning"],
        "broadcast": taught["broadcast"],
        "leader": before["leader"],
        "frame": before["frame"],
    }
    return after, _outputs(p, u, taught, seen, driven, linked)


def _begun(p: Signals, u: Signals, state: Parts) -> Parts:
    """The state, at the first sample that of a follower that drives as it does, in its place; V and W as matrices."""
    own, most = u["estimate.velocity.x"], realise.yaw_rate_limit(p, u["estimate.velocity.x"])
    told = broadcast.follow(p, u, state["broadcast"])
    bias = p["bias.own_speed"] * (1 - told["heard"]) * (1 - p["heard_rates"]) * own
    first = ca.vertcat(bias, ca.SX.zeros(network.N2), 0, ca.SX.zeros(network.N2))
    start = {
        "W": first,
        "velocity": ca.vertcat(bias, 0),
        "speed": ca.fmax(own, 0),
        "yaw_rate": clip(u["estimate.yaw_rate"], -most, most),
        "offset": offset.start(common.wanted_place(u)),
        "link": link.start(ca.fmax(own, 0)),
        "broadcast": told,
    }
    begun = common.begun(state, start)
    return begun | {"V": ca.reshape(state["V"], *_V), "W": ca.reshape(begun["W"], *_W)}


def _taught(p: Signals, u: Signals, before: Parts, seen: situation.LeaderSeen, linked: link.Link) -> Parts:
    """The weights after this sample; a limited channel and a leader not heard teach nothing."""
    tried = _drive(p, u, before, seen, linked)
    z = seen.z * (1 - p["freeze_limited"] * ca.vertcat(tried.speed.limited, tried.yaw_rate.limited))
    e = ca.if_else(p["leader_frame"], seen.R_rel.T @ z, z)
    learning = network.Learning(*(p[name] for name in _LEARNING))
    V, W = network.adapt(before["V"], before["W"], seen.xbar, e, learning, p["sample_period"])
    return choose(linked.heard, {"V": V, "W": W}, before)


def _drive(p: Signals, u: Signals, state: Parts, seen: situation.LeaderSeen, linked: link.Link) -> _Driven:
    """What the weights in `state` lead to, after the commands in it."""
    y = state["W"].T @ network.activation(state["V"], seen.xbar).sigma
    nu = ca.if_else(p["leader_frame"], y, seen.R_rel.T @ y)
    wanted = law.hand_velocity(p, seen.z, seen.R_rel @ nu + seen.known)
    time = p["realise.speed_time"] + p["headway"]
    following = realise.speed_towards(p, state["speed"], wanted[0], time)
    holding = link.hold_speed(p, linked.state, state["speed"], time)
    speed = realise.Realised(*(ca.if_else(linked.heard, *pair) for pair in zip(following, holding, strict=True)))
    turn = ca.if_else(linked.heard, wanted[1] / p["hand.distance"], 0)
    return _Driven(nu, speed, realise.yaw_rate(p, state["yaw_rate"], turn, u["estimate.velocity.x"]))


def _outputs(
    p: Signals, u: Signals, state: Parts, seen: situation.LeaderSeen, driven: _Driven, linked: link.Link
) -> Parts:
    own = {
        "weights.norm": ca.sqrt(ca.sumsqr(state["W"])),
        "weights.hidden_norm": ca.sqrt(ca.sumsqr(state["V"])),
        "gain_rule.broken": _rule_broken(p),
    }
    pairs = {"error": seen.z, "offset": seen.place, "velocity": driven.nu + broadcast.known(state["broadcast"])}
    return common.outputs(p, u, driven.speed, driven.yaw_rate, linked.heard) | common.by_axis(pairs) | own


def _rule_broken(p: Signals) -> ca.SX:
    """F > K^2/(2 (1 + N2/4)): the bias integrates with F |sigma|^2, which makes the damping fall below 0.7."""
    return p["adaptation.output"] * 2 * (1 + network.N2 / 4) > p["gain"] ** 2 * (1 + 1e-9)
