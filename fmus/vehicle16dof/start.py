"""The state at the start: static equilibrium, moving along the yaw direction, wheels rolling without slip."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Parts, Signals, block, slots
from fmus.vehicle16dof import attitude
from fmus.vehicle16dof.contact import contact
from fmus.vehicle16dof.interface import INTERFACE
from fmus.vehicle16dof.states import CORNERS, Corner, wheel_place


@block(p=slots(INTERFACE, "parameter"), u=slots(INTERFACE, "input"), rest=7)
def rolling(p: Signals, u: Signals, rest: ca.SX) -> Parts:
    """The states from s = (height, roll, pitch, travel (4)) of the static equilibrium."""
    height, roll, pitch, travel = rest[0], rest[1], rest[2], rest[3:]
    turned = attitude.from_angles(roll, pitch, p["initial.yaw"])
    level = attitude.rotation(attitude.from_angles(roll, pitch, ca.SX(0)))
    velocity = level[0, :].T * p["initial.speed"]
    spins = [_spin(p, u, corner, rest, n=level[2, :].T, velocity=velocity) for corner in CORNERS]
    position = ca.vertcat(p.vector("initial.position", "xy"), height)
    moving = {"position": position, "attitude": turned, "velocity": velocity}
    return moving | {"travel": travel, "wheel_speed": ca.vertcat(*spins)}


def _spin(p: Signals, u: Signals, corner: Corner, rest: ca.SX, *, n: ca.SX, velocity: ca.SX) -> ca.SX:
    """Spin [rad/s] without slip."""
    place = ca.vertcat(*wheel_place(p, corner)) + ca.vertcat(0, 0, rest[3 + corner.index])
    above = rest[0] + ca.dot(n, place) - u[f"road_height.{corner.name}"]
    touch = contact(p, n, ca.SX([0, 1, 0]), height=above, v=velocity, omega=ca.SX.zeros(3))
    return touch.V_x / touch.R_e
