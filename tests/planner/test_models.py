"""Single- and double-track cars against the published form, limits and conservation."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmus.cars import published
from fmus.double_track import model as double_track
from fmus.single_track import model
from tests.references import gear_shift
from tests.references.gerdts_form import gerdts
from tests.references.steady_turn import cornering_stiffness, understeer_gradient

CAR = published.single_track()
MIRROR = np.array([1, 1, 1, -1, 1, 1, 1])


def states(count: int, seed: int) -> np.ndarray:
    low = [-50, -5, 5, -0.3, -1, -1, -0.4]
    return np.random.default_rng(seed).uniform(low, [-x if x < 0 else 50 for x in low], (count, 7))


def test_sideslip_is_positive_to_the_left() -> None:
    f, rng = model.function(CAR), np.random.default_rng(2)
    for x in states(200, 1):
        u = rng.uniform([-0.5, -1e4, -5e3], [0.5, 5e3, 5e3])
        published = MIRROR * gerdts(MIRROR * x, u)
        np.testing.assert_allclose(f(x, u).full().ravel(), published, rtol=1e-12, atol=1e-12)


def test_published_friction_and_understeer() -> None:
    assert CAR.static_loads == pytest.approx((6515, 5640), abs=1)
    for tyre, load in zip((CAR.front, CAR.rear), CAR.static_loads, strict=True):
        assert tyre.D / load == pytest.approx(0.7, abs=1e-4)
    assert cornering_stiffness(CAR.front) == pytest.approx(64977, abs=1)
    assert cornering_stiffness(CAR.rear) == pytest.approx(65024, abs=1)
    assert understeer_gradient(CAR) == pytest.approx(1.38e-3, abs=5e-6)


def test_steady_turn_has_the_understeer_gradient() -> None:
    """delta = L/r + K a_y for small a_y: found by rest of the equations of motion, not by the formula."""
    v, a_y = 20.0, 0.05
    x, u = ca.SX.sym("x", 7), ca.SX.sym("u", 3)
    balance = ca.vertcat(model.derivative(CAR, x, u)[[2, 3, 5]], x[2] - v, x[5] - a_y / v)
    free = ca.vertcat(x[2], x[3], x[5], x[6], u[2])
    rest = ca.Function("rest", [free], [ca.substitute(balance, ca.vertcat(x[:2], x[4], u[:2]), ca.DM.zeros(5))])
    found = ca.rootfinder("steady", "newton", rest)(ca.DM([v, 0, a_y / v, 0, 100]))
    delta = float(found[3])
    assert delta == pytest.approx(CAR.wheelbase * a_y / v**2 + understeer_gradient(CAR) * a_y, rel=0.03)


def test_integration_by_an_independent_route() -> None:
    f = model.function(CAR)
    u = np.array([0.02, -500.0, 2000.0])
    start = np.array([0, 0, 20, 0, 0, 0, 0.0])
    ours = ca.integrator("i", "cvodes", _dae(f, u), 0, 2.0, {"abstol": 1e-11, "reltol": 1e-11})(x0=start)["xf"]
    other = solve_ivp(lambda _, x: gerdts(x, u), (0, 2), start, method="DOP853", rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(ours.full().ravel(), MIRROR * other.y[:, -1], rtol=1e-6, atol=1e-7)
    assert ours[1] > 0.5, "steering left did not move the car left"


def _dae(f: ca.Function, u: np.ndarray) -> dict[str, ca.SX]:
    x = ca.MX.sym("x", 7)
    return {"x": x, "ode": f(x, u)}


def test_combined_slip_weakens_cornering_only() -> None:
    x, u = np.array([0, 0, 20, 0.02, 0, 0.3, 0.05]), np.array([0, -4000.0, 0])
    free, bound = (model.function(CAR, mu)(x, u).full().ravel() for mu in (None, 1.0))
    factor = math.sqrt(1 - (4000 / CAR.static_loads[0]) ** 2 + 1e-4)
    alpha = x[6] - math.atan((CAR.l_F * 0.3 + 20 * math.sin(0.02)) / (20 * math.cos(0.02)))
    Ba = CAR.front.B * alpha
    F_t = CAR.front.D * math.sin(CAR.front.C * math.atan(Ba - CAR.front.E * (Ba - math.atan(Ba))))
    lost = CAR.l_F * F_t * (1 - factor) * math.cos(x[6]) / CAR.I_zz
    rear = CAR.l_R * (math.sqrt(1 + 1e-4) - 1) / CAR.I_zz * CAR.rear.D
    assert free[5] - bound[5] == pytest.approx(lost, abs=rear)
    assert np.isfinite(model.function(CAR, 1.0)(x, [0, -3e4, 3e4]).full()).all()


def test_double_track_becomes_single_track() -> None:
    narrow = replace(published.double_track(), d=0.0, h=0.0, least_load=0.0)
    f, g, rng = double_track.function(narrow), model.function(CAR), np.random.default_rng(4)
    for x in states(100, 3):
        rate, U_F, U_R = rng.uniform([-0.5, -1e4, -5e3], [0.5, 5e3, 5e3])
        four = f(x, [rate, U_F / 2, U_F / 2, U_R / 2, U_R / 2], rng.uniform(-9, 9, 2))[0]
        np.testing.assert_allclose(four.full(), g(x, [rate, U_F, U_R]).full(), rtol=0, atol=1e-9)


def test_wheel_loads() -> None:
    car, rng = published.double_track(), np.random.default_rng(5)
    a = ca.SX.sym("a", 2)
    loads = ca.Function("loads", [a], [double_track.wheel_loads(car, a[0], a[1])])
    for value in rng.uniform(-30, 30, (100, 2)):
        assert loads(value).full().sum() == pytest.approx(CAR.m * CAR.g, rel=1e-12)
    fl, fr, rl, rr = loads([3.0, 2.0]).full().ravel()
    # moments about the ground under the centre of gravity
    assert (fl + fr) * CAR.l_F - (rl + rr) * CAR.l_R == pytest.approx(-CAR.m * 3.0 * car.h)
    assert fr > fl and rr > rl, "a turn to the left loads the right wheels"


def test_double_track_forces_give_its_motion() -> None:
    """Newton's law in the world frame, forces added as plane vectors at the wheels."""
    car = published.double_track()
    f, rng = double_track.function(car), np.random.default_rng(6)
    for x in states(50, 7):
        u = rng.uniform([-0.5, *[-3e3] * 4], [0.5, *[3e3] * 4])
        x_dot, a, F_z, F_l, F_t, _ = (value.full().ravel() for value in f(x, u, rng.uniform(-4, 4, 2)))
        assert (F_z >= car.least_load).all()
        steer = np.exp(1j * np.array([x[6], x[6], 0, 0]))
        wheels = (F_l + 1j * F_t) * steer
        places = np.array([X + 1j * Y for X, Y in car.wheel_positions])
        drag = CAR.drag * x[2] ** 2
        world = (wheels.sum() - drag) * np.exp(1j * x[4]) / CAR.m
        change = (x_dot[2] + 1j * x[2] * (x_dot[3] + x_dot[4])) * np.exp(1j * (x[3] + x[4]))
        assert change == pytest.approx(world, abs=1e-10)
        assert complex(*a) == pytest.approx(world * np.exp(-1j * x[4]), abs=1e-10)
        assert x_dot[5] == pytest.approx((places.conj() * wheels).imag.sum() / CAR.I_zz, abs=1e-10)


def test_gears_mix_linearly() -> None:
    f, single = gear_shift.function(CAR), model.function(CAR)
    x = np.array([0, 0, 15, 0, 0, 0, 0.0])
    ratio = 2.002 * 3.91
    omega = 15 * ratio / 0.302
    f1 = 1 - math.exp(-3)
    torque = ratio * (f1 * (-37.8 + 1.54 * omega - 0.0019 * omega**2) + (1 - f1) * (-34.9 - 0.04775 * omega))
    second = f(x, [0, 300, 1, 1, 0, 0, 0]).full()
    np.testing.assert_allclose(second, single(x, [0, -200, torque / 0.302 - 100]).full(), atol=1e-12)
    third, half = f(x, [0, 300, 1, 0, 1, 0, 0]).full(), f(x, [0, 300, 1, 0.5, 0.5, 0, 0]).full()
    np.testing.assert_allclose(half, (second + third) / 2, atol=1e-12)
