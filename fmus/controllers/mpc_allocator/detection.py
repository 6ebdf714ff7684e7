"""Which motors are lost: forces seen in the slip of the wheels over forces asked for, by least squares with forgetting.

    response = (sum f F_seen F + F_0^2 n)/(sum f F^2 + F_0^2 n),   F_seen = c F_z (R omega - V)/V

f is the forgetting, n the number of samples remembered. The term with F_0 = `detection.force` holds the response of a
motor that is not asked for at one. It bounds false alarms: an error of F_seen by e changes it by e/(2 F_0) at most.
"""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals, block, slots
from fmus.cars.wheels import WHEELS
from fmus.controllers.mpc_allocator.design_car import SLOWEST, design_car
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_X
from fmus.double_track import distribution

STATES = Layout(
    turning=1,  # 1 once a wheel has been seen turning; until then their speeds may not be wired
    product=4,  # forgetting sum of force seen times force asked for [N2]
    square=4,  # of the square of the force asked for [N2]
    below=4,  # time for which the response has been too low [s]
    lost=4,  # 1 once it has been for long enough
)


@block(p=slots(INTERFACE, "parameter"), u=slots(INTERFACE, "input"), x=N_X, a=2, forces=4, before=STATES, usable=1)
def detected(
    p: Signals, u: Signals, x: ca.SX, a: ca.SX, forces: ca.SX, before: Parts, usable: ca.SX
) -> tuple[Parts, ca.SX]:
    """States and response (4) of the motors of the car in state x (7), which were asked for `forces` (4) [N].

    a       accelerations behind the wheel loads (2) [m/s2]
    before  states at the sample before
    usable  0: nothing is learnt; nor is it below 3 m/s
    """
    turning = ca.fmax(before["turning"], usable * (ca.mmax(ca.fabs(u.vector("wheel_speed", WHEELS))) > 0))
    learning = p["detection.enabled"] * usable * turning * (x[2] > SLOWEST)
    keep = ca.exp(-p["sample_period"] / p["detection.memory"])
    product = keep * before["product"] + forces_seen(p, u, x, a) * forces
    square = keep * before["square"] + forces**2
    product, square = (
        ca.if_else(learning, new, old) for new, old in ((product, before["product"]), (square, before["square"]))
    )
    held = p["detection.force"] ** 2 / (1 - keep)
    response = (product + held) / (square + held)
    low = response < p["detection.threshold"]
    below = low * (before["below"] + learning * p["sample_period"])
    lost = ca.fmax(before["lost"], low * (below > p["detection.delay"]))
    return {"turning": turning, "product": product, "square": square, "below": below, "lost": lost}, response


def forces_seen(p: Signals, u: Signals, x: ca.SX, a: ca.SX) -> ca.SX:
    """Forces (4) [N] that the slips of the wheels tell, under the loads of the accelerations a (2) [m/s2]."""
    car = design_car(p)
    v = ca.fmax(x[2], SLOWEST)
    _, F_z, _ = distribution.without_drive(car, ca.vertcat(x[:2], v, x[3:]), a)
    v_x, v_y = v * ca.cos(x[3]), v * ca.sin(x[3])
    steer = ca.vertcat(x[6], x[6], 0, 0)
    X, Y = (ca.vertcat(*column) for column in zip(*car.wheel_positions, strict=True))
    V = (v_x - x[5] * Y) * ca.cos(steer) + (v_y + x[5] * X) * ca.sin(steer)
    slip = car.planar.R * u.vector("wheel_speed", WHEELS) / ca.fmax(V, SLOWEST) - 1
    return p["actuator.slip_stiffness"] * F_z * slip
