"""The prediction of the controller against independent mathematics: scipy's exponential and integrator, the planner."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from mpc_loop import lane_change
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from fmukit.kernel import Signals, block, slots
from fmus.cars.published import double_track, single_track
from fmus.controllers.bus import PREVIEW, PREVIEW_PERIOD
from fmus.controllers.mpc_allocator import design_car, horizon, inversion, linearise, memory
from fmus.controllers.mpc_allocator.discretise import zero_order_hold
from fmus.controllers.mpc_allocator.horizon import NODES, PERIOD
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.double_track import model
from fmus.planner import check, plans

Array = np.ndarray
_START = {variable.name: float(variable.start) for variable in INTERFACE.select("parameter")}
_LAG = _START["actuator.steer_lag"]


def _parameters(**changed: float) -> Array:
    values = _START | {name.replace("__", "."): value for name, value in changed.items()}
    return np.array([values[name] for name in INTERFACE.names("parameter")])


@block(p=slots(INTERFACE, "parameter"), x=7, u=3, a=2)
def _rate(p: Signals, x: ca.SX, u: ca.SX, a: ca.SX) -> ca.SX:
    """x' of the design model."""
    return design_car.rate(design_car.design_car(p), p["actuator.steer_lag"], x, u, a)


@pytest.mark.parametrize("size", [0.1, 1.0, 4.0])
def test_zero_order_hold_is_the_matrix_exponential(size: float) -> None:
    draw = np.random.default_rng(1)
    A = draw.normal(size=(7, 7))
    A *= size / np.linalg.norm(A, 2)
    Phi, held = (ca.evalf(part).full() for part in zero_order_hold(ca.SX(ca.DM(A)), 1.0))
    block = expm(np.block([[A, np.eye(7)], [np.zeros((7, 14))]]))
    assert Phi == pytest.approx(block[:7, :7], rel=1e-8, abs=1e-8)
    assert held == pytest.approx(block[:7, 7:], rel=1e-8, abs=1e-8)


def test_without_forces_the_design_model_is_the_double_track_car() -> None:
    f, draw = model.function(double_track()), np.random.default_rng(2)
    for _ in range(20):
        x = draw.normal(size=7) * [10, 10, 3, 0.05, 1, 0.3, 0.05] + [0, 0, 20, 0, 0, 0, 0]
        a, command = draw.normal(size=2), 0.05 * draw.normal()
        ours = _rate(_parameters(), x, [command, 0.0, 0.0], a).full().ravel()
        theirs = f(x, [(command - x[6]) / _LAG, 0, 0, 0, 0], a)[0].full().ravel()
        assert ours == pytest.approx(theirs, rel=1e-12, abs=1e-12)


def test_forces_of_the_sides_are_those_of_the_wheels_at_straight_steering() -> None:
    f, draw = model.function(double_track()), np.random.default_rng(3)
    for _ in range(20):
        x = draw.normal(size=7) * [10, 10, 3, 0.05, 1, 0.3, 0.0] + [0, 0, 20, 0, 0, 0, 0]
        a, U = draw.normal(size=2), 1e3 * draw.normal(size=4)
        ours = _rate(_parameters(), x, [0.0, U[0] + U[2], U[1] + U[3]], a).full().ravel()
        assert ours == pytest.approx(f(x, [0, *U], a)[0].full().ravel(), rel=1e-12, abs=1e-9)


@block(p=slots(INTERFACE, "parameter"), z=2, s=3)
def _on_the_path(p: Signals, z: ca.SX, s: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """z at rest, z a period later, and the steering angle at z, all on a path of s = (v, a, kappa)."""
    car = design_car.design_car(p)
    later = inversion.advance(car, z, (s, s, s), PERIOD)
    return inversion.steady(car, s[0], s[2]), later, inversion.steering(car, z, s)


def _circle(speed: float, curvature: float, acceleration: float = 0.0) -> tuple[Array, Array]:
    """Two neighbouring nodes of the reference on a circle, after the zero dynamics have come to rest."""
    sample = [speed, acceleration, curvature]
    beta_omega, *_ = _on_the_path(_parameters(), [0.0, 0.0], sample)
    for _ in range(200):
        _, beta_omega, _ = _on_the_path(_parameters(), beta_omega, sample)
    z_end = beta_omega.full().ravel()
    delta = float(_on_the_path(_parameters(), z_end, sample)[2])
    nodes = []
    for t in (0.0, PERIOD):
        turn = speed * curvature * t
        x, y = (np.sin(turn) / curvature, (1 - np.cos(turn)) / curvature) if curvature else (speed * t, 0.0)
        nodes.append(np.array([x, y, turn, speed, acceleration, curvature, *z_end, delta]))
    return nodes[0], nodes[1]


@pytest.mark.parametrize(("speed", "curvature"), [(10.0, 0.03), (20.0, 0.01), (30.0, -0.005), (25.0, 0.0)])
def test_inversion_of_a_circle_is_an_equilibrium_of_the_car(speed: float, curvature: float) -> None:
    node, after = _circle(speed, curvature)
    _, _, c, u_r, e, w = (part.full() for part in linearise.predicted(_parameters(), node, after, np.zeros(6)))
    assert c.ravel() == pytest.approx(np.zeros(7), abs=1e-3)  # both wheels of an axle do not slip quite alike
    assert np.max(np.abs(c[:5])) < 5e-5
    assert np.max(np.abs(e)) == 0.0
    assert np.max(np.abs(w)) == 0.0
    state = linearise.state(ca.DM(node)).full().ravel()
    rate = _rate(_parameters(), state, u_r, [0.0, speed**2 * curvature]).full().ravel()
    assert rate[2] == pytest.approx(0.0, abs=1e-3)
    assert rate[3] == pytest.approx(0.0, abs=2e-3)
    assert rate[5] == pytest.approx(0.0, abs=5e-2)


@pytest.mark.parametrize(("speed", "curvature", "part"), [(20.0, 0.0, 1e-5), (10.0, 0.03, 1e-2), (25.0, 0.008, 1e-2)])
def test_prediction_is_the_derivative_of_the_integrated_car(speed: float, curvature: float, part: float) -> None:
    """Columns of Phi and Gamma by differences of scipy's solution in world axes, seen from the next node.

    On a straight the reference is an exact equilibrium, on a circle nearly one.
    """
    node, after = _circle(speed, curvature)
    found = [part.full() for part in linearise.predicted(_parameters(), node, after, np.zeros(6))]
    Phi, Gamma, u_r = found[0], found[1], found[3].ravel()
    start, loads = linearise.state(ca.DM(node)).full().ravel(), [0.0, speed**2 * curvature]

    def end(e: Array, w: Array) -> Array:
        def rate(t: float, x: Array) -> Array:
            return _rate(_parameters(), x, u_r + w, loads).full().ravel()

        x = solve_ivp(rate, (0.0, PERIOD), start + e, rtol=1e-11, atol=1e-13).y[:, -1]
        c, s = np.cos(after[2]), np.sin(after[2])
        return np.array([c * x[0] + s * x[1], c * x[1] - s * x[0], *x[2:]])

    sizes, nothing = np.array([1e-4] * 7), np.zeros(3)
    for j, h in enumerate(sizes):
        e = h * np.eye(7)[j]
        column = (end(e, nothing) - end(-e, nothing)) / (2 * h)
        assert Phi[:, j] == pytest.approx(column, rel=part, abs=0.1 * part * max(1.0, np.max(np.abs(column))))
    for j, h in enumerate([1e-4, 10.0, 10.0]):
        w = h * np.eye(3)[j]
        column = (end(np.zeros(7), w) - end(np.zeros(7), -w)) / (2 * h)
        assert Gamma[:, j] == pytest.approx(column, rel=part, abs=0.1 * part * np.max(np.abs(column)))


def test_steady_errors_are_an_equilibrium_under_the_disturbance() -> None:
    """On a straight, the car started beside the reference by the steady errors stays there, by scipy's integrator."""
    node, after = _circle(20.0, 0.0)
    d = np.array([0.05, -0.1, -0.4, 0.04, 0.01, 0.5])
    found = [part.full() for part in linearise.predicted(_parameters(), node, after, d)]
    u_r, e, w = (found[i].ravel() for i in (3, 4, 5))
    assert np.all(e[:2] == 0.0)
    assert np.all(np.abs(e[[2, 3, 4, 6]]) > 1e-3)
    start = linearise.state(ca.DM(node)).full().ravel() + e

    def rate(t: float, x: Array) -> Array:
        return np.add(_rate(_parameters(), x, u_r + w, [0.0, 0.0]).full().ravel(), [*d, 0.0])

    duration = 1.0
    x = solve_ivp(rate, (0.0, duration), start, rtol=1e-9, atol=1e-11).y[:, -1]
    assert x == pytest.approx(np.add(start, [20.0 * duration, 0, 0, 0, 0, 0, 0]), abs=1e-3)


def _bus_at(table: Array, t: float) -> Array:
    """The inputs of the controller with the rows of a table, linear between them: enough for a smooth plan."""
    values = {}
    for k in range(PREVIEW + 1):
        row = [np.interp(t + k * PREVIEW_PERIOD, table[:, 0], column) for column in table.T]
        prefix = "reference" if k == 0 else f"preview[{k}]"
        values |= {f"{prefix}.{name}": row[1 + i] for i, name in enumerate(memory.SAMPLE)}
    return np.array([values.get(name, 0.0) for name in INTERFACE.names("input")])


@block(symbol=ca.MX, p=slots(INTERFACE, "parameter"), u=slots(INTERFACE, "input"), z=2)
def _nodes(p: Signals, u: Signals, z: ca.MX) -> ca.MX:
    past = memory.straight(memory.now(u))
    passage = memory.Passage(ca.MX(0), ca.MX(1), ca.MX(0), ca.MX(memory.SEEN))
    path = memory.along(u, past, passage, horizon.times(ca.MX(PERIOD)))[:, : 2 * NODES + 1]
    return horizon.reference(p, z, path)


def test_inversion_finds_the_states_of_the_planned_car() -> None:
    """The plan is a motion of the single-track car: sideslip, yaw rate and steering angle come back from its path."""
    plan = plans.named("double-lane-change", 80, "gate", 10.0)
    times, x, _ = check.fine(plan.vehicle, plan.nodes, plan.substeps, check.FINER)
    level = _parameters(design__geometry__cog_height=0.0)
    z_now, found = np.zeros(2), []
    for k in range(0, 300, NODES):
        piece = _nodes(level, _bus_at(lane_change(), k * PERIOD), z_now).full()
        z_now = piece[6:8, -1]
        found.append(piece[:, :-1])
    ours = np.hstack(found)
    at = PERIOD * np.arange(ours.shape[1])
    for row, state, tolerance in ((6, 3, 1e-3), (7, 5, 0.01), (8, 6, 2e-3)):
        planned = np.interp(at, times, x[state])
        assert np.max(np.abs(planned)) > 10 * tolerance
        assert ours[row] == pytest.approx(planned, abs=tolerance)


@pytest.mark.parametrize("E", [-2.0, -0.5, 0.0, 0.9])
def test_tyre_inversion_gives_back_the_slip_angle(E: float) -> None:
    tyre = single_track().front
    tyre = type(tyre)(tyre.B, tyre.C, tyre.D, E)
    draw = np.linspace(-0.94, 0.94, 41)
    from fmus.single_track.forces import lateral  # noqa: PLC0415

    alpha = np.array([float(inversion.slip_for(tyre, ca.DM(part))) for part in draw])
    force = np.array([float(lateral(tyre, a)) for a in alpha])
    assert force / tyre.D == pytest.approx(draw, abs=1e-6)
    assert float(inversion.slip_for(tyre, ca.DM(5.0))) == pytest.approx(
        float(inversion.slip_for(tyre, ca.DM(inversion.FULL)))
    )
