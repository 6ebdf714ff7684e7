"""What a sample of AdaptiveFollower knows besides its weights: of its leader, and of the place it is wanted at."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from fmukit.kernel import Parts, Signals, choose
from fmus.cars.rotation import rotation_plane
from fmus.controllers.adaptive_follower import broadcast, law
from fmus.controllers.formation import catch_up, common, link, offset


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


def leader_speed(state: Parts) -> ca.SX:
    """Forward speed of the leader as far as known [m/s]."""
    return (state["velocity"] + broadcast.known(state["broadcast"]))[0]


def shifted(p: Signals, u: Signals, before: Parts) -> Parts:
    """The wanted place one sample later; a far one is approached as gently as the follower is led back from afar."""
    target = common.wanted_place(u)
    limits = catch_up.gentle(p, leader_speed(before), target - offset.value(before["offset"])[0])
    duration = offset.unhurried(before["offset"], target, p["formation.duration"], *limits)
    return offset.advance(before["offset"], target, p["sample_period"], duration)


def led_back(p: Signals, u: Signals, before: Parts, linked: link.Link) -> Parts:
    """The state of the wanted offset, begun anew nearby when the follower is far from its place."""
    away = rotation_plane(u["estimate.yaw"] - u["leader.yaw"]) @ seen(p, u, before).z
    anew = catch_up.led_back(p, before["offset"], away, leader_speed(before))
    return choose(linked.heard, anew, before["offset"])


def seen(p: Signals, u: Signals, before: Parts) -> LeaderSeen:
    """With the newest message, carried forward by what has been learnt and told up to now."""
    r, r_rate, _ = offset.value(before["offset"])
    place = r - ca.vertcat(p["headway"] * before["speed"], 0)
    leader = law.heard_leader(p, u, before["turning"]["rate"])
    known = broadcast.known(before["broadcast"])
    p_d = law.wanted_point(leader, place + ca.vertcat(p["hand.distance"], 0), before["velocity"] + known)
    z = law.error(p, u, p_d)
    relative = leader.yaw_now - u["estimate.yaw"]
    R_rel = rotation_plane(relative)
    return LeaderSeen(place, z, law.network_input(u, z, relative), R_rel, R_rel @ (known + r_rate))
