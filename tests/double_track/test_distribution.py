"""Force distribution: closed forms, an enumeration of all active sets against OSQP, limits of the wheels."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import casadi as ca
import numpy as np
import osqp
import pytest
from scipy import sparse

from fmukit.qp import qp_solver
from fmus.controllers.mpc_allocator.programs import WHEELS
from fmus.double_track import data, distribution, model
from fmus.double_track.distribution import Limits, Weights

CAR = data.car()
NONE = np.zeros(4)
ALL = np.ones(4)
LIMITS = Limits(force=3e3, power=math.inf, rate=2e4, friction=1.0)
WEIGHTS = Weights(force_x=1.0, force_y=1.0, moment=1.0, epsilon=1e-3, rho=0.0)
Array = np.ndarray
Program = tuple[Array, Array, Array, Array]


def numbers(*values: object) -> tuple[Array, ...]:
    return tuple(ca.DM(value).full().ravel() for value in values)


def program(
    wanted: tuple[Array, Array, Array], before: Array, low: Array, high: Array, w: Weights = WEIGHTS
) -> Program:
    """P (4 x 4), q, low, high [kN] of `distribution.problem`, its pattern unpacked."""
    P_nz, q, A_nz, low, high = distribution.problem(*wanted, previous=before, low=low, high=high, weights=w)
    upper = ca.DM(distribution.PATTERN_P, P_nz).full()
    np.testing.assert_array_equal(ca.DM(distribution.PATTERN_A, A_nz).full(), np.eye(4))
    return upper + np.triu(upper, 1).T, *numbers(q, low, high)


def best(P: Array, q: Array, low: Array, high: Array) -> Array:
    """The minimum of a strictly convex box problem: the best of what the 3^4 sets of active bounds give inside it."""
    found: list[tuple[float, Array]] = []
    for sides in itertools.product((-1, 0, 1), repeat=4):
        free = np.array(sides) == 0
        x = np.where(np.array(sides) < 0, low, high)
        if free.any():
            x[free] = np.linalg.solve(P[np.ix_(free, free)], -(q + P[:, ~free] @ x[~free])[free])
        if (x >= low - 1e-12).all() and (x <= high + 1e-12).all():
            found.append((0.5 * x @ P @ x + q @ x, x))
    return min(found, key=lambda pair: pair[0])[1]


def by_osqp(P: Array, q: Array, low: Array, high: Array) -> Array:
    solver = osqp.OSQP()
    options = {"eps_abs": 1e-9, "eps_rel": 1e-9, "max_iter": 50000, "scaling": 0, "verbose": False}
    solver.setup(sparse.csc_matrix(np.triu(P)), q, sparse.eye(4, format="csc"), low, high, **options)
    found = solver.solve(raise_error=False)
    assert found.info.status == "solved"
    return np.asarray(found.x)


def optimality(P: Array, q: Array, low: Array, high: Array, x: Array) -> float:
    """Largest violation of the Kuhn-Tucker conditions: x is its own projected gradient step."""
    return float(np.max(np.abs(x - np.clip(x - (P @ x + q), low, high))))


def wish(rng: np.random.Generator) -> tuple[Array, Array, Array]:
    """Random G, c, y*."""
    G = ca.DM(distribution.effectiveness(CAR, rng.uniform(-0.4, 0.4))).full()
    return G, rng.normal(size=3) * [1e3, 3e3, 2e3], rng.normal(size=3) * [6e3, 3e3, 3e3]


@pytest.mark.parametrize("seed", range(5))
def test_affine_map_is_the_double_track_car(seed: int) -> None:
    """y of the car's own equations at random states and forces, wheel loads held."""
    rng = np.random.default_rng(seed)
    x = np.array([0, 0, *rng.uniform([5, -0.1, 0, -0.5, -0.3], [40, 0.1, 1, 0.5, 0.3])])
    a, U, p = rng.uniform(-5, 5, 2), rng.uniform(-3e3, 3e3, 4), CAR.planar
    x_dot, acceleration = (v.full().ravel() for v in model.function(CAR)(x, [0, *U], a)[:2])
    G, (c, F_z, F_t) = distribution.effectiveness(CAR, x[6]), distribution.without_drive(CAR, x, a)
    y = ca.DM(G @ U + c).full().ravel()
    np.testing.assert_allclose(y, [*(p.m * acceleration), p.I_zz * x_dot[5]], rtol=1e-9, atol=1e-6)
    assert float(ca.sum1(F_z)) == pytest.approx(p.m * p.g)
    assert float(ca.norm_2(F_t)) > 1.0


@pytest.mark.parametrize("seed", range(10))
def test_without_active_bound_it_is_regularised_least_squares(seed: int) -> None:
    """U = G_w' (G_w G_w' + (epsilon + rho) I)^-1 ..., its dual form, and its residual in closed form."""
    rng = np.random.default_rng(seed)
    G, c, y = wish(rng)
    before, w = rng.uniform(-1e3, 1e3, 4), Weights(1.0, 2.0, rng.uniform(1, 20), 1e-3, rng.choice([0.0, 1e-2]))
    W = np.diag([w.force_x, w.force_y, w.moment])
    total, centre = w.epsilon + w.rho, w.rho * before / (w.epsilon + w.rho)
    lack = np.linalg.solve(np.eye(3) + G @ G.T @ W / total, y - c - G @ centre)
    expected = centre + G.T @ W @ lack / total
    for solve in (best, by_osqp):
        U = distribution.N * solve(*program((G, c, y), before, -1e6 * ALL, 1e6 * ALL, w))
        np.testing.assert_allclose(U, expected, atol=0.01)
        np.testing.assert_allclose(numbers(distribution.residual(G, c, y, U))[0], -lack, atol=0.02)


def test_without_regularisation_it_is_the_pseudo_inverse() -> None:
    G, c, y = wish(np.random.default_rng(0))
    U = distribution.N * best(*program((G, c, y), NONE, -1e7 * ALL, 1e7 * ALL, replace(WEIGHTS, epsilon=1e-9)))
    np.testing.assert_allclose(U, np.linalg.pinv(G) @ (y - c), rtol=1e-4)
    assert np.abs(numbers(distribution.residual(G, c, y, U))[0]).max() < 1e-2


def test_random_bounds() -> None:
    """200 problems, most with active bounds, some wheels lost: OSQP is at the optimum, which the enumeration finds."""
    rng = np.random.default_rng(1)
    active = 0
    for _ in range(200):
        low, high = (rng.uniform(0, 3e3, 4) * (rng.random(4) > 0.15) for _ in range(2))
        weights = replace(WEIGHTS, moment=rng.uniform(1, 20), rho=rng.choice([0.0, 1e-2]))
        qp = program(wish(rng), rng.uniform(-3e3, 3e3, 4), -low, high, weights)
        exact, found = best(*qp), by_osqp(*qp)
        assert optimality(*qp, exact) < 1e-9
        assert optimality(*qp, found) < 1e-6
        np.testing.assert_allclose(found, exact, atol=1e-5)
        active += int(((exact <= qp[2]) | (exact >= qp[3])).any())
    assert active > 150


def test_generated_code() -> None:
    """100 problems for the C code that MpcAllocator runs, each from a cold start.

    With tight tolerances it is at the optimum. With those of MpcAllocator the motion is within 0.5 N and 0.5 N.m of the
    best; what is left, up to 5 N, is between wheels that do much the same.
    """
    rng = np.random.default_rng(5)
    settings = (replace(WHEELS, absolute=1e-9, relative=1e-9, iterations=20000), WHEELS)
    solvers = [qp_solver("wheels", distribution.PATTERN_P, distribution.PATTERN_A, s).function for s in settings]
    for _ in range(100):
        low, high = (rng.uniform(0, 3e3, 4) * (rng.random(4) > 0.15) for _ in range(2))
        wanted, before, weights = (
            wish(rng),
            rng.uniform(-3e3, 3e3, 4),
            replace(WEIGHTS, moment=rng.uniform(1, 20), rho=1e-2),
        )
        raw = distribution.problem(*wanted, previous=before, low=-low, high=high, weights=weights)
        tight, own = (solve(*raw, NONE, NONE, WHEELS.rho, 0) for solve in solvers)
        assert int(tight[3]) == int(own[3]) == 1
        full = program(wanted, before, -low, high, weights)
        assert optimality(*full, tight[0].full().ravel()) < 1e-6
        lack = distribution.N * (own[0].full().ravel() - best(*full))
        assert np.abs(lack).max() < 5
        assert np.abs(wanted[0] @ lack).max() < 0.5


def test_all_wheels_lost() -> None:
    G, c, y = wish(np.random.default_rng(2))
    low, high = numbers(
        *distribution.bounds(LIMITS, 3e3 * ALL, NONE, 20.0, available=NONE, previous=1e3 * ALL, period=0.02)
    )
    np.testing.assert_array_equal([*low, *high], 0.0)
    for solve in (best, by_osqp):
        U = distribution.N * solve(*program((G, c, y), 1e3 * ALL, low, high))
        np.testing.assert_allclose(U, 0.0, atol=1e-4)
        np.testing.assert_allclose(numbers(distribution.residual(G, c, y, U))[0], c - y, atol=1e-3)


def test_a_lost_wheel_is_replaced_by_its_neighbour() -> None:
    """Straight ahead with rr lost, yaw protected: fr does its work; the sum of forces and the moment are kept."""
    G = ca.DM(distribution.effectiveness(CAR, 0.0)).full()
    low, high = numbers(*distribution.bounds(LIMITS, 3e3 * ALL, NONE, 20.0, available=np.array([1, 1, 1, 0])))
    U = distribution.N * best(*program((G, np.zeros(3), np.array([3e3, 0, 0])), NONE, low, high))
    np.testing.assert_allclose(U, [750, 1500, 750, 0], rtol=2e-3)


def test_limits_of_a_wheel() -> None:
    """One wheel per limit: force, power, friction beside a lateral force, a lost motor."""
    load, lateral = np.array([9e3, 9e3, 3e3, 9e3]), np.array([0, 0, 1.8e3, 0])
    low, high = numbers(*distribution.bounds(LIMITS, load, lateral, 10.0, available=np.array([1, 1, 1, 0])))
    np.testing.assert_allclose(high, [3e3, 3e3, 2.4e3, 0])
    np.testing.assert_allclose(low, -high)
    low, high = numbers(
        *distribution.bounds(replace(LIMITS, power=6e4), load, lateral, 30.0, available=np.array([1, 1, 1, 0]))
    )
    np.testing.assert_allclose(high, [2e3, 2e3, 2e3, 0])
    np.testing.assert_allclose(low, [-2e3, -2e3, -2e3, 0])
    low, high = numbers(*distribution.bounds(LIMITS, load, 1e4 * ALL, 10.0, available=ALL))
    np.testing.assert_array_equal([*low, *high], 0.0)


def test_rate_limit_yields_to_friction() -> None:
    """20 kN/s for 20 ms is 400 N: around 1 kN a step either way; a grip of 300 N is out of reach and wins."""
    before = np.array([1e3, 2.9e3, 1e3, -1e3])
    load = np.array([9e3, 9e3, 300.0, 300.0])
    low, high = numbers(*distribution.bounds(LIMITS, load, NONE, 20.0, available=ALL, previous=before, period=0.02))
    np.testing.assert_allclose(low, [600, 2500, 300, -300])
    np.testing.assert_allclose(high, [1400, 3000, 300, -300])


def test_bounds_hold_for_anything() -> None:
    """500 random wheels: never crossed, inside every limit, and no narrower than the narrowest of them allows."""
    rng = np.random.default_rng(3)
    for _ in range(500):
        limits = Limits(*rng.uniform(0, [5e3, 1e5, 5e4, 1.5]))
        F_z, F_t = rng.uniform(0, 6e3, 4), rng.uniform(-6e3, 6e3, 4)
        v, available, before = rng.uniform(0, 60), rng.integers(0, 2, 4), rng.uniform(-6e3, 6e3, 4)
        low, high = numbers(
            *distribution.bounds(limits, F_z, F_t, v, available=available, previous=before, period=0.02)
        )
        grip = np.sqrt(np.maximum((limits.friction * F_z) ** 2 - F_t**2, 0))
        motor = min(limits.force, limits.power / max(v, 1.0)) * available
        assert (low <= high).all()
        assert (high <= np.minimum(grip, motor) + 1e-9).all()
        assert (low >= -np.minimum(grip, motor) - 1e-9).all()
        assert (high - low <= 2 * limits.rate * 0.02 + 1e-9).all()
        inside = np.clip(before, -np.minimum(grip, motor), np.minimum(grip, motor))
        reached = np.abs(inside - before) <= limits.rate * 0.02
        assert (np.where(reached, (low <= inside + 1e-9) & (inside <= high + 1e-9), low == high)).all()


def test_more_limit_never_hurts() -> None:
    """The cost of the optimum falls as friction or motor force rise, and with a sound wheel instead of a lost one."""
    rng = np.random.default_rng(4)
    for _ in range(50):
        wanted, F_z, F_t = wish(rng), rng.uniform(1e3, 5e3, 4), rng.uniform(-2e3, 2e3, 4)
        costs = []
        for force, friction, sound in ((1e3, 0.5, 0), (2e3, 0.5, 0), (2e3, 1.0, 0), (2e3, 1.0, 1)):
            available = np.array([1, 1, 1, sound])
            low, high = distribution.bounds(
                replace(LIMITS, force=force, friction=friction), F_z, F_t, 20.0, available=available
            )
            P, q, least, most = program(wanted, NONE, low, high)
            x = best(P, q, least, most)
            costs.append(0.5 * x @ P @ x + q @ x)
        assert all(later <= sooner + 1e-9 for sooner, later in itertools.pairwise(costs))


def test_symbols_give_the_same_numbers() -> None:
    """As the kernel uses it: everything a symbol, also the car's width."""
    d, delta = ca.SX.sym("d"), ca.SX.sym("delta")
    car = data.DoubleTrackCar(CAR.planar, d, CAR.h, CAR.least_load)
    G = ca.Function("G", [d, delta], [distribution.effectiveness(car, delta)])
    expected = ca.DM(distribution.effectiveness(CAR, 0.1)).full()
    np.testing.assert_allclose(G(CAR.d, 0.1).full(), expected)
    assert expected[2, 1] == pytest.approx(CAR.planar.l_F * math.sin(0.1) + CAR.d * math.cos(0.1))
