"""The right-hand side x' = f(p, d, u, x): contacts, forces, dynamics, kinematics put together."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Parts, Signals
from fmus.vehicle16dof import attitude, friction, suspension, tyre
from fmus.vehicle16dof.contact import Contact, contact
from fmus.vehicle16dof.dynamics import Accelerations, Leg, accelerations
from fmus.vehicle16dof.states import CORNERS, Corner, over_wheels, wheel_place


@dataclass(frozen=True, slots=True)
class WheelForces:
    """One corner: contact, tyre force and leg, its force [N] and moment about O1 [N.m] on the car in K1, slip rates.

    spin      rate [rad/s] of the wheel about its axle against the road: that of the joint and of the knuckle
    carrier   angular velocity [rad/s] of the knuckle (3)
    brake, scrub   torques [N.m] of dry friction, against the wheel's joint and against turning on the spot
    """

    contact: Contact
    tyre: tyre.TyreForce
    leg: Leg
    force: ca.SX
    moment: ca.SX
    slip_rates: tuple[ca.SX, ca.SX]
    spin: ca.SX
    carrier: ca.SX
    brake: ca.SX
    scrub: ca.SX


@dataclass(frozen=True, slots=True)
class MultibodyInstant:
    """The car at an instant: rotation body to world (3 x 3), gravity in K1 [m/s2] (3), wheels, accelerations."""

    R: ca.SX
    gravity: ca.SX
    wheels: list[WheelForces]
    accelerations: Accelerations


def evaluate(p: Signals, d: Parts, u: Signals, x: Parts) -> MultibodyInstant:
    """Everything instantaneous about the car in state x under the inputs u; d holds the mass distribution."""
    R = attitude.rotation(x["attitude"])
    n, omega = R[2, :].T, x["angular_rate"]
    springs = suspension.corner_forces(p, u, x["travel"], x["travel_rate"])
    wheels = [_wheel(p, u, x, corner, n=n, spring=springs[corner.index]) for corner in CORNERS]
    force = over_wheels([w.force for w in wheels]) + u.vector("body_force", "xyz") + drag(p, x["velocity"])
    moment = over_wheels([w.moment for w in wheels]) + u.vector("body_moment", "xyz")
    solved = accelerations(p, d, omega, [w.leg for w in wheels], force=force, moment=moment)
    return MultibodyInstant(R, -p["gravity"] * n, wheels, solved)


def derivative(p: Signals, d: Parts, u: Signals, x: Parts) -> Parts:
    """x' by name."""
    now = evaluate(p, d, u, x)
    a, omega = now.accelerations, x["angular_rate"]
    slips = [wheel.slip_rates for wheel in now.wheels]
    return {
        "position": now.R @ x["velocity"],
        "attitude": attitude.rate(x["attitude"], omega),
        "velocity": a.specific_force + now.gravity - ca.cross(omega, x["velocity"]),
        "angular_rate": a.angular,
        "travel": x["travel_rate"],
        "travel_rate": a.travel,
        "steer": x["steer_rate"],
        "steer_rate": a.steer,
        "wheel_angle": x["wheel_speed"],
        "wheel_speed": a.spin,
        "slip_ratio": ca.vertcat(*(along for along, _ in slips)),
        "slip_tangent": ca.vertcat(*(across for _, across in slips)),
    }


def drag(p: Signals, v: ca.SX) -> ca.SX:
    """Air drag [N] along -x_1 at O1."""
    area = 0.5 * p["air.density"] * p["body.drag_coefficient"] * p["body.frontal_area"]
    return ca.vertcat(-area * v[0] * ca.fabs(v[0]), 0, 0)


def _wheel(p: Signals, u: Signals, x: Parts, corner: Corner, *, n: ca.SX, spring: ca.SX) -> WheelForces:
    i, k = corner.index, tyre.TyreData(p)
    x_w, y_w, z_w = wheel_place(p, corner)
    place, travel_rate, spin = ca.vertcat(x_w, y_w, z_w + x["travel"][i]), x["travel_rate"][i], x["wheel_speed"][i]
    delta, turn = (x["steer"][i], x["steer_rate"][i]) if corner.steered else (ca.SX(0), ca.SX(0))
    s, c, omega = ca.sin(delta), ca.cos(delta), x["angular_rate"]
    axle, carrier = ca.vertcat(-s, c, 0), omega + ca.vertcat(0, 0, turn)
    velocity = x["velocity"] + ca.cross(omega, place) + ca.vertcat(0, 0, travel_rate)
    height = x["position"][2] + ca.dot(n, place) - u[f"road_height.{corner.name}"]
    touch = contact(p, n, axle, height=height, v=velocity, omega=carrier)
    slips, rolling = (x["slip_ratio"][i], x["slip_tangent"][i]), spin + ca.dot(axle, omega)
    road, stick_time = u[f"road_friction.{corner.name}"], p["brake.stick_time"]
    tyre_force = tyre.force(k, touch, road, rolling, slips)
    F_x, across = tyre_force.F_x, tyre_force.F_y * touch.y + touch.F_z * n
    about_axle = -(F_x * touch.R_e + tyre_force.rolling)
    about_centre = ca.cross(touch.arm, across) + tyre_force.M_z * touch.upright + about_axle * axle
    scrub = turning = ca.SX(0)
    if corner.steered:
        turning = about_centre[2] + suspension.steering_moment(p, u[f"steer_torque.{corner.name}"], delta, turn)
        inertia = p["knuckle.inertia.z"] + p["wheel.inertia.diametral"]
        scrub = friction.dry(tyre.scrub_capacity(k, touch, road, carrier[2]), turning, inertia * carrier[2], stick_time)
        about_centre, turning = about_centre - ca.vertcat(0, 0, scrub), turning - scrub
    load = u[f"motor_available.{corner.name}"] * u[f"wheel_torque.{corner.name}"] + about_axle
    brake = friction.dry(u[f"brake_torque.{corner.name}"], load, p["wheel.inertia.spin"] * spin, stick_time)
    leg = Leg(
        place,
        travel_rate,
        s,
        c,
        turn,
        spin,
        corner.steered,
        Q_travel=across[2] + F_x * touch.x[2] - spring,
        Q_steer=turning,
        Q_spin=load - brake,
    )
    force = across + F_x * touch.x
    moment, rates = ca.cross(place, force) + about_centre, tyre.slip_rates(k, touch, rolling, slips)
    return WheelForces(touch, tyre_force, leg, force, moment, rates, rolling, carrier, brake, scrub)
