"""What a sample of AdaptiveFollower knows besides its weights: of its leader, and of the place it is wanted at."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from fmukit.kernel import Parts, Signals, choose
from fmus.cars.rotation import rotation_plane
from fmus.controllers.adaptive_follower import broadcast, law
from fmus.controllers.formation import catch_up, common, frame, leader, link, offset
from fmus.controllers.formation.moving import MovingPlace


class LeaderSeen(NamedTuple):
    """What a sample knows besides the weights.

    The wanted place of O1, z, xbar, R(psi_L - psi_i), and Delta without the network's share.
    """

    place: ca.SX
    z: ca.SX
    xbar: ca.SX
    R_rel: ca.SX
    known: ca.SX


def told(p: Signals, u: Signals, before: Parts) -> Parts:
    """`before` with the newest broadcast; from the first one on the network only has to know what that leaves."""
    after = broadcast.follow(p, u, before["broadcast"])
    nu = broadcast.just_told(before["broadcast"], after)
    heard = law.heard_leader(p, u, before["turning"]["rate"])
    y = ca.if_else(p["leader_frame"], nu, rotation_plane(heard.yaw_now - u["estimate.yaw"]) @ nu)
    W = ca.vertcat(before["W"][0, :] - y.T, before["W"][1:, :])
    return before | {"broadcast": after, "W": W, "velocity": before["velocity"] - nu}


def carried(p: Signals) -> ca.SX:
    """1 where the wanted place is carried forward as the leader was heard to move, 0 where with what is learnt."""
    return ca.fmax(p["heard_rates"], p["frame.trailing"])


def leader_speed(p: Signals, state: Parts) -> ca.SX:
    """Forward speed of the leader as far as known [m/s]."""
    learnt = (state["velocity"] + broadcast.known(state["broadcast"]))[0]
    return ca.if_else(carried(p) * state["leader"]["heard"], state["leader"]["w"][0], learnt)


def place(p: Signals, before: Parts) -> MovingPlace:
    """The wanted offset of O1 (2) with the derivatives of its quintic; the command of the speed makes up for those of
    the headway."""
    r, rate, acceleration = offset.value(before["offset"])
    return MovingPlace(r - ca.vertcat(p["headway"] * before["speed"], 0), rate, acceleration)


def towed(p: Signals, u: Signals, before: Parts, linked: link.Link) -> Parts:
    """The state of the rod that trails from the leader's hand."""
    return frame.follow(p, u, before["frame"], leader.motion(p, before["leader"]), place(p, before), linked.heard)


def shifted(p: Signals, u: Signals, before: Parts) -> Parts:
    """The wanted place one sample later; a far one is approached as gently as the follower is led back from afar."""
    target = common.wanted_place(u)
    limits = catch_up.gentle(p, leader_speed(p, before), target - offset.value(before["offset"])[0])
    duration = offset.unhurried(before["offset"], target, p["formation.duration"], *limits)
    return offset.advance(before["offset"], target, p["sample_period"], duration)


def led_back(p: Signals, u: Signals, before: Parts, linked: link.Link) -> Parts:
    """The state of the wanted offset, begun anew nearby when the follower is far from its place."""
    now = seen(p, u, before)
    axes = ca.if_else(carried(p), now.R_rel.T, rotation_plane(u["estimate.yaw"] - u["leader.yaw"]))
    anew = catch_up.led_back(p, before["offset"], axes @ now.z, leader_speed(p, before))
    return choose(linked.heard, anew, before["offset"])


def seen(p: Signals, u: Signals, before: Parts) -> LeaderSeen:
    """With the newest message, carried forward by what has been learnt and told up to now."""
    r = place(p, before)
    ahead = leader.motion(p, before["leader"])
    axes = frame.motion(p, before["frame"], ahead, r)
    wanted = frame.wanted_hand(ahead, axes, r, p["hand.distance"])
    silent = law.heard_leader(p, u, before["turning"]["rate"])
    told = broadcast.known(before["broadcast"])
    p_d = law.wanted_point(silent, r.place + ca.vertcat(p["hand.distance"], 0), before["velocity"] + told)
    z = law.error(p, u, ca.if_else(carried(p), wanted.place, p_d))
    relative = ca.if_else(carried(p), axes.place, silent.yaw_now) - u["estimate.yaw"]
    R_rel = rotation_plane(relative)
    known = ca.if_else(p["heard_rates"], law.driven_ahead(p, u, wanted), R_rel @ (told + r.rate))
    return LeaderSeen(r.place, z, law.network_input(u, z, relative), R_rel, known)
