"""The planar car that stands for Vehicle16Dof, against that car's own tyre and masses."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import fsolve

from fmukit.direct import Direct
from fmus import vehicle16dof
from fmus.cars.axle_fit import MOST_SLIP
from fmus.cars.derived import single_track
from fmus.cars.nominal import DESIGN, plant_values
from fmus.cars.wheels import FRONT, WHEELS
from fmus.controllers import low_level_pid, mpc_allocator
from fmus.planner import trajectory
from fmus.planner.errors import PlanningError
from fmus.planner.hocp import PlanSettings, plan
from fmus.planner.planned_cars import multibody
from fmus.planner.program import standing_ends
from fmus.planner.road import double_lane_change
from fmus.planner.vehicle import two_wheel_drive
from fmus.single_track.forces import lateral
from fmus.single_track.model import function
from fmus.single_track.model import slips as slip_angles
from fmus.vehicle16dof import magic
from tests.references.steady_turn import understeer_gradient

PLANT, CAR = plant_values(), single_track(DESIGN)


@pytest.mark.parametrize("a_y", [1.0, 3.0, 5.0, 7.0])
def test_axles_carry_the_steady_turn_of_the_plants_tyres(a_y: float) -> None:
    """Slip angles of both axles from the balance of forces and moments of the four tyres, each with its own trail."""
    k = {name.removeprefix("tyre."): value for name, value in PLANT.items() if name.startswith("tyre.")}
    D, (roll_F, roll_R) = DESIGN, DESIGN.roll_stiffness
    height = D.cog_height / (1 - D.mass * D.gravity * D.cog_height / (roll_F + roll_R))
    whole = D.mass * a_y * height / D.track / (roll_F + roll_R)

    def axle(load: float, transfer: float, alpha: float) -> tuple[float, float]:
        loads = (load / 2 - transfer, load / 2 + transfer)
        forces = [-magic.lateral(math, k, F_z, 1.0, math.tan(alpha)) for F_z in loads]
        fade = 1 - math.tan(alpha) / k["trail_vanishing_slip"]
        moments = [-k["trail"] * fade * F_z / 4000.0 * F_y for F_z, F_y in zip(loads, forces, strict=True)]
        return sum(forces), sum(moments)

    def balance(slips: list[float]) -> list[float]:
        (F_F, M_F), (F_R, M_R) = (
            axle(load, whole * roll, alpha)
            for load, roll, alpha in zip(CAR.static_loads, (roll_F, roll_R), slips, strict=True)
        )
        return [F_F + F_R - D.mass * a_y, CAR.l_F * F_F - CAR.l_R * F_R + M_F + M_R]

    slips = fsolve(balance, [0.012 * a_y, 0.01 * a_y], xtol=1e-12)
    for tyre, alpha, arm in zip((CAR.front, CAR.rear), slips, (CAR.l_R, CAR.l_F), strict=True):
        assert float(lateral(tyre, ca.DM(alpha))) == pytest.approx(D.mass * a_y * arm / D.wheelbase, rel=0.01)


@pytest.mark.parametrize(
    ("speed", "steer", "a_y", "off"), [(12.0, 0.08, 3.9, 0.02), (20.0, 0.03, 3.5, 0.05), (20.0, 0.06, 6.2, 0.08)]
)
def test_curvature_is_that_of_the_multibody_car(speed: float, steer: float, a_y: float, off: float) -> None:
    """A steady turn of Vehicle16Dof with driven wheels; the planar car at its speed and steering angle.

    Rolling resistance, which turns the loaded side back, and the lift of the front by the drag are left out there.
    """
    heavy = Direct(vehicle16dof.COMPONENT, {"initial.speed": speed})
    torque = 0.0
    for i in range(2000):
        error = speed - heavy["velocity.x"]
        torque += 100.0 * error * 0.002
        asked = steer * min(i * 0.002, 1.0)
        servo = {w: 4e4 * (asked - heavy[f"steer_angle.{w}"]) - 200.0 * heavy[f"steer_rate.{w}"] for w in FRONT}
        heavy.set({f"steer_torque.{w}": servo[w] for w in FRONT})
        heavy.set({f"wheel_torque.{w}": torque + 250.0 * error for w in WHEELS})
        heavy.advance(0.002)
    v, r = math.hypot(heavy["velocity.x"], heavy["velocity.y"]), heavy["angular_rate.z"]
    delta, f = sum(heavy[f"steer_angle.{w}"] for w in FRONT) / 2, function(CAR)

    def rest(z: list[float]) -> list[float]:
        return [
            float(rate)
            for i, rate in enumerate(ca.vertsplit(f([0, 0, v, z[0], 0, z[1], delta], [0, 0, z[2]])))
            if i in (2, 3, 5)
        ]

    assert heavy["acceleration.y"] == pytest.approx(a_y, abs=0.3)
    assert heavy["acceleration.y"] == pytest.approx(v * r, rel=0.02)
    assert fsolve(rest, [0.0, r, 300.0])[1] == pytest.approx(r, rel=off)


def test_masses_and_loads() -> None:
    assert CAR.m == 1500.0 and CAR.I_zz == pytest.approx(2539, abs=1)
    assert sum(CAR.static_loads) == pytest.approx(1500.0 * PLANT["gravity"])
    assert understeer_gradient(CAR) > 0


def test_it_can_be_planned() -> None:
    found = plan(two_wheel_drive(CAR), double_lane_change(), 40, settings=PlanSettings(compile=False))
    assert 6 < found.final_time < 9 and found.replay_error() < 0.01


LIMITS = multibody(DESIGN).vehicle


def loads(a_x: float) -> tuple[float, float]:
    """Axle loads [N] under a longitudinal acceleration."""
    transfer = DESIGN.mass * a_x * DESIGN.cog_height / DESIGN.wheelbase
    front, rear = CAR.static_loads
    return front - transfer, rear + transfer


@pytest.mark.parametrize("force", LIMITS.input_upper[1:].tolist() + LIMITS.input_lower[1:].tolist())
def test_planned_forces_are_within_grip_motors_and_brakes(force: float) -> None:
    """At the largest drive and brake force, wheel by wheel with the pitch of the car, against the plant's own tyre."""
    k = {name.removeprefix("tyre."): value for name, value in PLANT.items() if name.startswith("tyre.")}
    mpc = {v.name: float(v.start) for v in mpc_allocator.COMPONENT.interface.select("parameter")}
    low_level = {v.name: float(v.start) for v in low_level_pid.COMPONENT.interface.select("parameter")}
    axles = [float(part) for part in LIMITS.axle_forces([0.0, force]).full().ravel()]
    assert sum(axles) == pytest.approx(force)
    for axle, load in zip(axles, loads(force / DESIGN.mass), strict=True):
        peak = max(magic.longitudinal(math, k, load / 2, 1.0, kappa / 1000) for kappa in range(20, 300))
        assert abs(axle) / 2 < 0.9 * peak
        assert abs(axle) / 2 <= mpc["limit.force"]
        assert abs(axle) / 2 * DESIGN.wheel_radius <= 2e4
    limit = "speed.drive_limit" if force > 0 else "speed.brake_limit"
    assert abs(force) <= low_level[limit] * DESIGN.mass * DESIGN.gravity


@pytest.mark.parametrize("speed", [10.0, 30.0])
def test_plan_for_the_multibody_car_keeps_grip(speed: float) -> None:
    """Slip stays where the axles are fitted, and acceleration keeps a fifth of the grip, which ends at 7.9 m/s2."""
    found = plan(LIMITS, double_lane_change(), 40, standing_ends(speed), PlanSettings(compile=False))
    slips = np.array([[float(a) for a in slip_angles(CAR, x)] for x in found.nodes.x.T])
    across = trajectory.table(found)[:, 4] ** 2 * trajectory.table(found)[:, 6]
    assert np.abs(slips).max() < MOST_SLIP + 0.02
    assert 3.5 < np.abs(across).max() < 0.88 * 7.9
    assert found.replay_error(restart=True) < 0.01


@pytest.mark.parametrize("grip", [0.0, 1.1, math.nan])
def test_impossible_grip(grip: float) -> None:
    with pytest.raises(PlanningError, match=f"plan with is {grip:g}"):
        multibody(DESIGN, grip)
