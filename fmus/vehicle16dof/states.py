"""The named slices of state and derived data, and the four corners of the car. Units SI; wheels fl, fr, rl, rr."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Layout, Signals

STATES = Layout(
    position=3,  # of O1 in the world
    attitude=4,  # unit quaternion (w, x, y, z), body to world
    velocity=3,  # of O1 in K1
    angular_rate=3,  # in K1
    travel=4,
    travel_rate=4,
    steer=2,
    steer_rate=2,
    wheel_angle=4,
    wheel_speed=4,
    slip_ratio=4,  # kappa' of the relaxing tyre
    slip_tangent=4,  # tan(alpha') of the relaxing tyre
)

DERIVED = Layout(
    mass=1,  # sprung mass with payload
    mass_moment=3,  # m rho_c1 of the sprung body about O1
    inertia=6,  # J_1 about O1: xx, yy, zz, xy, xz, yz
    inverse_mass=2,  # 1/(sprung mass), 1/(total mass)
    unsprung_moment=2,  # sums of m_u x and m_u y over the wheels
    unsprung_inertia=1,  # sum of m_u (x^2 + y^2)
)


@dataclass(frozen=True, slots=True)
class Corner:
    """One wheel: its index, axle, side (+1 left) and the index of the wheel on the other side."""

    index: int
    name: str
    axle: str
    side: float
    opposite: int

    @property
    def steered(self) -> bool:
        """Whether the wheel has a kingpin: those of the front axle."""
        return self.axle == "front"


CORNERS = (
    Corner(0, "fl", "front", 1.0, 1),
    Corner(1, "fr", "front", -1.0, 0),
    Corner(2, "rl", "rear", 1.0, 3),
    Corner(3, "rr", "rear", -1.0, 2),
)


def wheel_place(p: Signals, corner: Corner) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Wheel centre in K1 [m] at zero travel."""
    x = p["geometry.front_axle"] if corner.steered else -p["geometry.rear_axle"]
    return x, corner.side * 0.5 * p[f"geometry.track_{corner.axle}"], -p[f"geometry.wheel_drop_{corner.axle}"]


def unsprung_mass(p: Signals) -> ca.SX:
    """Mass [kg] of one knuckle and wheel."""
    return p["knuckle.mass"] + p["wheel.mass"]


def over_wheels(values: list[ca.SX]) -> ca.SX:
    """Sum over the wheels, left and right paired first so that a mirrored car rounds alike."""
    fl, fr, rl, rr = values
    return (fl + fr) + (rl + rr)


def symmetric(xx_yy_zz_xy_xz_yz: ca.SX) -> ca.SX:
    """The symmetric 3x3 matrix of its six elements."""
    xx, yy, zz, xy, xz, yz = ca.vertsplit(xx_yy_zz_xy_xz_yz)
    return ca.vertcat(ca.horzcat(xx, xy, xz), ca.horzcat(xy, yy, yz), ca.horzcat(xz, yz, zz))
