"""Forces along a plan: reference residuals, and the file against the equations of both cars evaluated anew."""

from __future__ import annotations

import csv
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fmus.cars.published import double_track
from fmus.controllers import mpc_allocator
from fmus.double_track import model
from fmus.double_track.distribution import Limits, Weights
from fmus.planner import forces, trajectory
from fmus.planner.errors import PlanningError
from fmus.planner.hocp import Plan, PlanSettings, plan
from fmus.planner.road import double_lane_change
from fmus.planner.vehicle import two_wheel_drive
from fmus.single_track import model as single
from fmus.single_track.forces import air_drag, rolling_coefficient
from tests.references.gear_shift import gear_shift_car

CAR = double_track()
LIMITS = Limits(force=3e3, power=np.inf, rate=np.inf, friction=1.0)
WEIGHTS = Weights(force_x=1.0, force_y=1.0, moment=1.0, epsilon=1e-3, rho=0.0)
LOST = (1.0, 1.0, 1.0, 0.0)
Y = ("force_x", "force_y", "moment_z")


@pytest.fixture(scope="module")
def drive() -> Plan:
    """The thesis' form of the problem: time grid, 160 intervals."""
    settings = PlanSettings(grid="time", compile=False)
    return plan(two_wheel_drive(CAR.planar), double_lane_change(), 160, settings=settings)


@pytest.mark.parametrize(
    ("options", "rms", "largest"),
    [
        ({}, (1.3, 41, 0.2), None),
        ({"available": LOST}, (21, 48, 24.6), (99, 106, 117)),
        ({"available": LOST, "weights": replace(WEIGHTS, moment=20.0)}, (45, 48, 2.7), None),
        ({"available": LOST, "limits": replace(LIMITS, force=4e3)}, (8, 48, 9), None),
    ],
)
def test_reference_residuals(drive: Plan, options: dict, rms: tuple, largest: tuple | None) -> None:
    """Values of an independent prototype, kept to 5 %; its figures of one digit are rounded."""
    found = forces.along(drive, CAR, finer=1, **({"limits": LIMITS, "weights": WEIGHTS} | options))
    np.testing.assert_allclose(found.rms, rms, rtol=0.05, atol=0.01)
    if largest is not None:
        np.testing.assert_allclose(found.largest, largest, rtol=0.04)


def test_limits_and_weights_are_those_of_the_controller(drive: Plan) -> None:
    """Unless given: its file of parameters, without the weight of the change, with the friction of the plan."""
    own = tomllib.loads((Path(mpc_allocator.__file__).parent / "parameters.toml").read_text("utf-8"))
    value = {name: entry["value"] for name, entry in own.items()}
    names = ("force_x", "force_y", "moment_z", "regularisation")
    w = Weights(*(value[f"distribution.{name}"] for name in names), rho=0.0)
    motors = Limits(*(value[f"limit.{name}"] for name in ("force", "power", "force_rate")), friction=1.0)
    found, expected = (
        forces.along(drive, CAR, finer=1, available=LOST, **o) for o in ({}, {"limits": motors, "weights": w})
    )
    np.testing.assert_array_equal(found.U, expected.U)
    assert forces.default_limits(0.8) == replace(motors, friction=0.8)


def test_file_holds_what_both_cars_say(drive: Plan, tmp_path: Path) -> None:
    """Its states are those of the trajectory; both cars, evaluated at its rows, move as its columns say."""
    forces.write(forces.along(drive, CAR, available=LOST), tmp_path / "forces.csv")
    trajectory.write(drive, tmp_path / "plan.csv")
    path = np.loadtxt(tmp_path / "plan.csv", delimiter=",", skiprows=1)
    with (tmp_path / "forces.csv").open(newline="") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    assert len(rows) == len(path) == 1601
    f, p = model.function(CAR), CAR.planar
    for row, planned in zip(rows[::40], path[::40], strict=True):
        x = np.array([row[name] for name in single.STATES])
        np.testing.assert_allclose([row["time"], *x[:2], x[3] + x[4], x[2]], planned[:5], atol=1e-6)
        U, y = [row[f"wheel_force.{w}"] for w in ("fl", "fr", "rl", "rr")], np.array([row[f"wanted.{n}"] for n in Y])
        x_dot, acceleration = f(x, [row["omega_delta"], *U], y[:2] / p.m)[:2]
        given = np.array([*(p.m * acceleration.full().ravel()), p.I_zz * float(x_dot[5])])
        np.testing.assert_allclose(given - y, [row[f"residual.{n}"] for n in Y], atol=1e-3)
        np.testing.assert_allclose(
            y, by_forces(x, row["axle_force.front"], row["axle_force.rear"]), rtol=1e-6, atol=1e-2
        )
        assert U[3] == 0.0


def by_forces(x: np.ndarray, U_F: float, U_R: float) -> list[float]:
    """F_x, F_y, M_z summed from the forces of both axles and the air."""
    p = CAR.planar
    alpha, tyres = single.slips(p, x), (p.front, p.rear)
    F_t = [
        t.D * np.sin(t.C * np.arctan(t.B * a - t.E * (t.B * a - np.arctan(t.B * a))))
        for t, a in zip(tyres, map(float, alpha), strict=True)
    ]
    F_l = [U - float(rolling_coefficient(p, x[2])) * load for U, load in zip((U_F, U_R), p.static_loads, strict=True)]
    c, s = np.cos(x[6]), np.sin(x[6])
    front = F_l[0] * s + F_t[0] * c
    F_x = F_l[0] * c - F_t[0] * s + F_l[1] - float(air_drag(p, x[2]))
    return [F_x, front + F_t[1], p.l_F * front - p.l_R * F_t[1]]


def test_nothing_left_to_drive(drive: Plan) -> None:
    """All motors lost: no forces, and what is missing is all that drove and braked, but for 1 - cos delta of it."""
    found = forces.along(drive, CAR, available=(0.0, 0.0, 0.0, 0.0), finer=1)
    np.testing.assert_array_equal(found.U, 0.0)
    np.testing.assert_allclose(-found.residual[0], found.inputs[1] + found.inputs[2], atol=20)


def test_mistakes(drive: Plan, tmp_path: Path) -> None:
    with pytest.raises(PlanningError, match="cannot be written"):
        forces.write(forces.along(drive, CAR, finer=1), tmp_path / "none" / "forces.csv")
    shifting = plan(gear_shift_car(CAR.planar), double_lane_change(), 10, settings=PlanSettings(compile=False))
    with pytest.raises(PlanningError, match="not known of the car gear_shift"):
        forces.along(shifting, CAR)
