"""The formation error and the law: from what is measured to wanted speed and yaw rate."""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from fmukit.kernel import Signals
from fmus.cars.rotation import rotation_plane
from fmus.controllers.formation import hand
from fmus.controllers.formation.moving import MovingPlace

_ERROR, _SPEED = 5.0, 30.0  # m, m/s; what the network's inputs are relative to


class Leader(NamedTuple):
    """Pose in the newest message, its age [s], and the yaw rate [rad/s] seen in the messages."""

    position: ca.SX
    yaw: ca.SX
    age: ca.SX
    turning: ca.SX

    @property
    def yaw_now(self) -> ca.SX:
        return self.yaw + self.age * self.turning


def heard_leader(p: Signals, u: Signals, turning: ca.SX) -> Leader:
    """The leader as last heard; nothing is carried forward further than `link.patience`."""
    age = ca.fmin(u["leader.age"], p["link.patience"])
    return Leader(u.vector("leader.position", "xy"), u["leader.yaw"], age, turning)


def wanted_point(leader: Leader, r: ca.SX, nu: ca.SX) -> ca.SX:
    """p_d [m] (2) now: p_L + R(psi_L) r at the time of the message, moved on with nu, its velocity in leader axes.

    The direction of nu is that in the middle of the time since then.
    """
    midway = leader.yaw + 0.5 * leader.age * leader.turning
    return leader.position + rotation_plane(leader.yaw) @ r + leader.age * rotation_plane(midway) @ nu


def error(p: Signals, u: Signals, p_d: ca.SX) -> ca.SX:
    """z = R(psi_i)' (p_i - p_d) [m] (2), p_i the hand point."""
    psi = u["estimate.yaw"]
    p_i = hand.point(u.vector("estimate.position", "xy"), psi, p["hand.distance"])
    return rotation_plane(psi).T @ (p_i - p_d)


def network_input(u: Signals, z: ca.SX, relative: ca.SX) -> ca.SX:
    """xbar = [1, tanh(z/5 m), sin, cos of psi_L - psi_i, own speed/(30 m/s), own yaw rate/(1 rad/s)] (7)."""
    own = ca.vertcat(u["estimate.velocity.x"] / _SPEED, u["estimate.yaw_rate"])
    return ca.vertcat(1, ca.tanh(z / _ERROR), ca.sin(relative), ca.cos(relative), own)


def hand_velocity(p: Signals, z: ca.SX, Delta: ca.SX) -> ca.SX:
    """[v_i; a omega_i] = -K z + Delta_hat (2) [m/s]; Delta_hat with all that is known of the wanted point's motion."""
    return -p["gain"] * z + Delta


def driven_ahead(p: Signals, u: Signals, wanted: MovingPlace) -> ca.SX:
    """Delta [m/s] (2) of a wanted hand whose motion is heard: R_i' h_d', as early as the commands are late.

    Of b = R_i' h_d' in axes that turn with b_y/a, as those of a follower in its place do, b' = R_i' h_d'' - b_y/a S b.
    """
    R = rotation_plane(u["estimate.yaw"]).T
    b = R @ wanted.rate
    changing = R @ wanted.acceleration - b[1] / p["hand.distance"] * hand.S @ b
    late = ca.vertcat(p["realise.speed_time"] + p["lead.speed"], p["lead.yaw_rate"])
    return b + late * changing
