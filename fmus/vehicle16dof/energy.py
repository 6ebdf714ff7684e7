"""What the car has of energy, what drives it, and where the power goes.

motors + steering + suspension + external = d/dt (kinetic + gravity + elastic)
                                            + brakes + tyres + rolling + dampers + drag
"""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Parts, Signals
from fmus.cars.wheels import FRONT, WHEELS
from fmus.vehicle16dof import suspension
from fmus.vehicle16dof.dynamics import inertias
from fmus.vehicle16dof.equations import MultibodyInstant, WheelForces, drag
from fmus.vehicle16dof.states import CORNERS, Corner, over_wheels, symmetric, unsprung_mass


def energies(p: Signals, d: Parts, x: Parts, now: MultibodyInstant) -> Parts:
    """What is stored [J], by the names of `balance.STORES`."""
    v, omega, m_u = x["velocity"], x["angular_rate"], unsprung_mass(p)
    body = 0.5 * d["mass"] * ca.sumsqr(v) + ca.dot(v, ca.cross(omega, d["mass_moment"]))
    body += 0.5 * ca.dot(omega, symmetric(d["inertia"]) @ omega)
    legs = [0.5 * m_u * ca.sumsqr(_velocity(x, w)) + _rotation(p, omega, w) for w in now.wheels]
    moment = d["mass_moment"] + m_u * over_wheels([w.leg.place for w in now.wheels])
    height = (d["mass"] + 4 * m_u) * x["position"][2] + ca.dot(now.R[2, :].T, moment)
    tyres = [0.5 * p["tyre.vertical_stiffness"] * w.contact.delta**2 for w in now.wheels]
    springs = over_wheels(suspension.stored(p, x["travel"])) + suspension.steering_stored(p, x["steer"])
    return {
        "kinetic": body + over_wheels(legs),
        "gravity": p["gravity"] * height,
        "elastic": springs + over_wheels(tyres),
    }


def powers(p: Signals, u: Signals, x: Parts, now: MultibodyInstant) -> Parts:
    """What flows [W], by the names of `balance.SOURCES` and `balance.SINKS`."""
    v, omega, rate = x["velocity"], x["angular_rate"], x["travel_rate"]
    external = ca.dot(u.vector("body_force", "xyz"), v) + ca.dot(u.vector("body_moment", "xyz"), omega)
    dampers = [_damping(p, c, w) for c, w in zip(CORNERS, now.wheels, strict=True)]
    return {
        "motors": ca.dot(u.vector("motor_available", WHEELS) * u.vector("wheel_torque", WHEELS), x["wheel_speed"]),
        "steering": ca.dot(u.vector("steer_torque", FRONT), x["steer_rate"]),
        "suspension": -ca.dot(u.vector("suspension_force", WHEELS), rate),
        "external": external,
        "brakes": over_wheels([w.brake * w.leg.spin for w in now.wheels]),
        "tyres": over_wheels([_slipping(w) for w in now.wheels]),
        "rolling": over_wheels([w.tyre.rolling * w.spin for w in now.wheels]),
        "dampers": over_wheels(dampers) + p["steering.damping"] * ca.sumsqr(x["steer_rate"]),
        "drag": -ca.dot(drag(p, v), v),
    }


def _velocity(x: Parts, w: WheelForces) -> ca.SX:
    """Of the wheel centre, in K1 [m/s]."""
    return x["velocity"] + ca.cross(x["angular_rate"], w.leg.place) + ca.vertcat(0, 0, w.leg.travel_rate)


def _rotation(p: Signals, omega: ca.SX, w: WheelForces) -> ca.SX:
    """Energy [J] of the rotation of knuckle and wheel."""
    A, B, C = inertias(p)
    s, c = w.leg.sine, w.leg.cosine
    w_x, w_y = c * omega[0] + s * omega[1], c * omega[1] - s * omega[0]
    return 0.5 * (A * w_x**2 + B * w_y**2 + C * w.carrier[2] ** 2 + p["wheel.inertia.spin"] * w.spin**2)


def _slipping(w: WheelForces) -> ca.SX:
    """Power [W] of the forces along and across the track, of the aligning moment and of scrub."""
    touch, force = w.contact, w.tyre
    sliding = force.F_x * (touch.V_x - w.spin * touch.R_e) + force.F_y * touch.V_y
    return w.scrub * w.carrier[2] - sliding - force.M_z * ca.dot(touch.upright, w.carrier)


def _damping(p: Signals, corner: Corner, w: WheelForces) -> ca.SX:
    """Power [W] lost in the damper of a corner, and in its tyre, whose road gives less than its spring."""
    tyre = (w.contact.spring - w.contact.F_z) * w.contact.V_n
    return p[f"suspension.{corner.axle}.damping"] * w.leg.travel_rate**2 + tyre
