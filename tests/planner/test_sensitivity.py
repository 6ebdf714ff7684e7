"""Derivatives put together by hand against those of CasADi, and against the integrator of SciPy."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmus.cars.published import single_track
from fmus.planner import gate_grid, time_grid
from fmus.planner.check import motion
from fmus.planner.path_road import PathRoad
from fmus.planner.program import Ends, NonlinearProgram, standing_ends
from fmus.planner.road import double_lane_change
from fmus.planner.shooting import derivatives, interval
from fmus.planner.vehicle import Vehicle, two_wheel_drive
from tests.references.gear_shift import gear_shift_car

CAR = single_track()
CARS = [two_wheel_drive(CAR), two_wheel_drive(CAR, friction=1.0), gear_shift_car(CAR)]


@pytest.mark.parametrize("vehicle", CARS, ids=["plain", "combined slip", "gears"])
@pytest.mark.parametrize("substeps", [1, 2, 3])
def test_interval_against_casadi(vehicle: Vehicle, substeps: int) -> None:
    n_u, rng = len(vehicle.input_scale), np.random.default_rng(substeps)
    x, u, T, mu = (ca.MX.sym("y", size) for size in (7, n_u, 1, 7))
    y, end = ca.vertcat(x, u, T), interval(vehicle.f, substeps)(x, u, T)
    hessian = ca.triu(ca.hessian(ca.dot(mu, end), y)[0])
    by_casadi = ca.Function("by_casadi", [x, u, T, mu], [ca.jacobian(end, y), hessian])
    found = derivatives(vehicle.f, substeps)
    for _ in range(3):
        start = np.array([3, 1, 20, 0.05, 0.1, 0.3, 0.05]) * rng.uniform(0.5, 1.5, 7)
        inputs, weights = rng.uniform(0.1, 1, n_u) * vehicle.input_scale, rng.normal(size=7)
        for seen, expected in zip(
            (found.first(start, inputs, 0.1), found.second(start, inputs, 0.1, weights)),
            by_casadi(start, inputs, 0.1, weights),
            strict=True,
        ):
            size = float(ca.norm_inf(expected))
            np.testing.assert_allclose(ca.densify(seen).full(), ca.densify(expected).full(), atol=1e-11 * size)


def oval() -> PathRoad:
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    return PathRoad(np.column_stack([60 * np.cos(angle), 40 * np.sin(angle)]), np.full((40, 2), 3.0), closed=True)


def programs() -> dict[str, NonlinearProgram]:
    """One of each kind: gates, closed road, gears with their limits, equal times with the road as inequalities."""
    free, road = np.full(7, np.nan), double_lane_change()
    return {
        "gates": gate_grid.program(CARS[0], road.gates(6), standing_ends(), substeps=2, smoothing=1e-4),
        "closed": gate_grid.program(CARS[1], oval().gates(12), Ends(free, free), substeps=2, smoothing=1e-4),
        "gears": gate_grid.program(CARS[2], road.gates(6), standing_ends(), substeps=3, smoothing=0.0),
        "times": time_grid.program(CARS[0], road, 6, standing_ends(), substeps=2, smoothing=1e-4),
    }


@pytest.mark.parametrize("name", ["gates", "closed", "gears", "times"])
def test_program_against_casadi(name: str) -> None:
    program, rng = programs()[name], np.random.default_rng(1)
    w, p, f, g = (program.nlp[key] for key in "xpfg")
    weight, weights = ca.MX.sym("weight"), ca.MX.sym("weights", g.numel())
    hessian = ca.triu(ca.hessian(weight * f + ca.dot(weights, g), w)[0])
    by_casadi = ca.Function("by_casadi", [w, p, weight, weights], [g, ca.jacobian(g, w), hessian])
    point = rng.uniform(np.clip(program.lower, -1, 1), np.clip(program.upper, -1, 1))
    lam = rng.normal(size=g.numel())
    expected = by_casadi(point, program.parameters, 0.7, lam)
    seen = (
        *program.derivatives["jac_g"](point, program.parameters),
        program.derivatives["hess_lag"](point, program.parameters, 0.7, lam),
    )
    for one, other in zip(seen, expected, strict=True):
        size = float(ca.norm_inf(ca.densify(other)))
        np.testing.assert_allclose(ca.densify(one).full(), ca.densify(other).full(), atol=1e-11 * size)
    assert seen[2].sparsity().is_triu()


def test_interval_converges_with_order_four() -> None:
    """Halving the substep divides the error by sixteen, against a tight integrator."""
    vehicle, start, inputs = CARS[0], np.array([0, 0, 20, 0.02, 0.0, 0.2, 0.03]), np.array([0.3, -1e3, 2e3])
    exact = solve_ivp(motion, (0, 0.4), start, "DOP853", rtol=1e-12, atol=1e-12, args=(vehicle, inputs)).y[:, -1]
    counts = np.array([4, 8, 16, 32])
    errors = [np.abs(interval(vehicle.f, int(k))(start, inputs, 0.4).full().ravel() - exact).max() for k in counts]
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert order == pytest.approx(4, abs=0.25)
