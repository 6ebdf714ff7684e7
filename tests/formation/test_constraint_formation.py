"""Formations of ConstraintFollowers: assembling, changing shape, pushes, and what joint multipliers would do."""

from __future__ import annotations

import casadi as ca
import constraint_loop as loop
import numpy as np
import pytest
from scipy.signal import lsim

from fmus.controllers.constraint_follower import constraints
from tests.references import joint_rows

Place = tuple[float, float]

DIAMOND = ((-8.0, 4.0), (-8.0, -4.0), (-16.0, 0.0))
LINE = ((-8.0, 0.0), (-16.0, 0.0), (-24.0, 0.0))
WEDGE = ((-6.0, 4.0), (-12.0, 8.0), (-18.0, 12.0))
MASS, FORCE = 1500.0, 2000.0  # kg, N
EXACT = {"leader__filter_time": 0.05}  # messages without noise at every sample


def _shape(t: float) -> tuple[Place, ...]:
    return DIAMOND if t < 15.0 else LINE if t < 30.0 else WEDGE


class Formation:
    """Three followers of one leader (star), or each of the one before (chain)."""

    def __init__(self, leader: loop.Motion, start: list[tuple[float, ...]], lag: float | None = None, **p: float):
        self.leader, self.vehicles = leader, [loop.Vehicle(np.array(s, float), lag) for s in start]
        self.followers = [loop.follower(**p) for _ in start]
        self.t, self.errors, self.seen = 0.0, [], []

    def step(
        self, places: tuple[Place, ...], *, chain: bool, pushes: dict[int, Place] | None = None, **u: float
    ) -> None:
        leader = np.append(self.leader(self.t), 0.0)
        given = {name.replace("__", "."): value for name, value in u.items()}
        states, row, outputs = [leader, *(v.state.copy() for v in self.vehicles)], [], []
        for i, (follower, vehicle) in enumerate(zip(self.followers, self.vehicles, strict=True)):
            ahead = states[i if chain else 0]
            inputs = loop.message(ahead) | loop.estimate(states[i + 1]) | given
            y = follower.step(inputs | {"formation.x": places[i][0], "formation.y": places[i][1]})
            row.append(np.hypot(*loop.error(states[i + 1], ahead, (y["offset.x"], y["offset.y"]))))
            outputs.append(y)
            vehicle.drive(y, (pushes or {}).get(i, (0.0, 0.0)))
        self.errors.append(row)
        self.seen.append(outputs)
        self.t += loop.T


def _changes(lag: float | None, **p: float) -> tuple[np.ndarray, Formation]:
    """Errors (samples x 3) of diamond -> line -> wedge on an S-curve, from up to 5.4 m beside the places.

    The leader drives at 20 m/s and turns by up to 0.12 rad/s to either side, 2.4 m/s2, with a period of 20 s.
    """
    away = ((-4.0, 3.0), (3.0, -4.0), (2.0, 5.0))
    start = [(r[0] + d[0], r[1] + d[1], 0.0, 20.0, 0.0) for r, d in zip(DIAMOND, away, strict=True)]
    formation = Formation(loop.s_curve(), start, lag, **p)
    for k in range(2250):
        formation.step(_shape(k * loop.T), chain=False)
    return np.array(formation.errors), formation


def test_formation_assembles_and_changes_within_two_centimetres() -> None:
    e, formation = _changes(None)
    assert e[0].max() > 5.0
    assert e[150].max() < 0.22 * e[0].max()  # (1 + t) exp(-t) is 0.2 after 3 s
    assert e[500].max() < 0.02
    assert e[600:].max() < 0.02
    lateral = [np.abs(np.array(v.rows)[600:, 3] * np.array(v.rows)[600:, 4]).max() for v in formation.vehicles]
    assert max(lateral) < 4.5
    assert not any(y["saturation.speed"] + y["saturation.yaw_rate"] for outputs in formation.seen for y in outputs)


def _lagging(rows: np.ndarray, lag: float) -> np.ndarray:
    """Error (n) that a lag leaves of the motion in `rows` (n x 6) of a vehicle without one.

    Behind a lag the hand misses tau times the rate of the commands' accelerations, (v'', a omega'' + (v omega)') in
    body axes, and the error answers by tau s^3 + s^2 + 2 s + 1.
    """
    t, (yaw, v, w) = loop.T * np.arange(len(rows)), rows[:, 2:5].T
    dv, dw = np.gradient(v, loop.T), np.gradient(w, loop.T)
    body = lag * np.array([np.gradient(dv, loop.T), np.gradient(loop.A * dw + v * w, loop.T)])
    c, s = np.cos(yaw), np.sin(yaw)
    world = np.array([c * body[0] - s * body[1], s * body[0] + c * body[1]])
    return np.hypot(*(lsim(([1.0], [lag, 1.0, 2.0, 1.0]), d, t)[1] for d in world))


@pytest.mark.parametrize(("lag", "most"), [(0.1, 0.17), (0.2, 0.36)])
def test_actuators_that_lag_leave_what_the_motion_asks_of_them(lag: float, most: float) -> None:
    """Decimetres, car by car and at every instant those of a third-order equation on paper, to 2 cm."""
    (e, _), (_, prompt) = _changes(lag), _changes(None)
    on_paper = np.array([_lagging(np.array(v.rows), lag) for v in prompt.vehicles]).T
    assert 0.9 * most < e[600:].max() < most
    assert e[600:] == pytest.approx(on_paper[600:], abs=0.02)


def test_actuators_whose_lag_is_known_leave_centimetres() -> None:
    assert _changes(0.2, lead__speed=0.2, lead__yaw_rate=0.2)[0][600:].max() < 0.02


def test_a_chain_changes_within_two_centimetres_too() -> None:
    """Each follower derives the acceleration of the one before, which changes its place itself: a short memory."""
    steps = (((-8.0, 4.0), (0.0, -8.0), (-8.0, 4.0)), ((-8.0, 0.0),) * 3, ((-6.0, 4.0),) * 3)
    start = [(-8.0, 4.0, 0.0, 20.0, 0.0), (-8.0, -4.0, 0.0, 20.0, 0.0), (-16.0, 0.0, 0.0, 20.0, 0.0)]
    formation = Formation(loop.s_curve(), start, **EXACT)
    for k in range(2250):
        formation.step(steps[k * loop.T >= 15.0] if k * loop.T < 30.0 else steps[2], chain=True)
    assert np.array(formation.errors)[600:].max() < 0.02


def _free_answer() -> float:
    """Largest error of e'' + 2 e' + e = F/m for a push of one second."""
    t = np.linspace(0.0, 10.0, 10001)
    return float(np.max(lsim(([1.0], [1.0, 2.0, 1.0]), (t < 1.0) * FORCE / MASS, t)[1]))


def _pushed(car: int, across: bool, **p: float) -> Formation:
    """A chain of three on a straight, one of them pushed for a second."""
    start = [(-10.0 * (k + 1), 0.0, 0.0, 20.0, 0.0) for k in range(3)]
    formation = Formation(loop.steady(20.0), start, **p)
    push = (0.0, FORCE / MASS) if across else (-FORCE / MASS, 0.0)
    for k in range(600):
        formation.step(((-10.0, 0.0),) * 3, chain=True, pushes={car: push} if 50 <= k < 100 else {})
    return formation


@pytest.mark.parametrize("across", [True, False])
def test_a_pushed_car_answers_like_its_constraint_and_nothing_goes_forward(across: bool) -> None:
    e = np.array(_pushed(2, across).errors).max(axis=0)
    assert e[2] == pytest.approx(_free_answer(), rel=0.02)
    assert e[:2].max() < 1e-6  # nobody ahead hears of it


def _known_late(ahead: np.ndarray, tau: float) -> np.ndarray:
    """Error (n) behind a car with the states `ahead` (n x 6), whose motion is known by the filter only.

    1/(s + 1)^2 times what the filter misses of the wanted place's acceleration, of its velocity times K_d = 2 and of
    its position: the continuous filter x1' = x2 + 3 i/tau, x2' = x3 + 3 i/tau^2, x3' = i/tau^3 of i = v - x1 has
    1 - x2/v' = tau^2 s^2 (tau s + 3)/(tau s + 1)^3 and i/v' = tau^3 s^2/(tau s + 1)^3, and position lags v - x1 by tau.
    """
    place = np.array([s[:2] + (loop.A - 10.0) * np.array([np.cos(s[2]), np.sin(s[2])]) for s in ahead])
    acceleration = np.gradient(np.gradient(place, loop.T, axis=0), loop.T, axis=0)
    lag, twice = np.poly1d([tau, 1.0]), np.poly1d([1.0, 0.0, 0.0])
    missed = twice * (tau**2 * np.poly1d([tau, 3.0]) * lag + 2.0 * tau**3 * lag + tau**4)
    answer = missed.coeffs, (lag**4 * np.poly1d([1.0, 1.0]) ** 2).coeffs
    return np.hypot(*(lsim(answer, part, loop.T * np.arange(len(part)))[1] for part in acceleration.T))


@pytest.mark.parametrize("tau", [0.1, 0.2, 0.3])
@pytest.mark.parametrize("across", [True, False])
def test_behind_a_pushed_car_the_links_miss_only_what_the_filter_does(across: bool, tau: float) -> None:
    """Along, it is that on paper; across, less, because omega v, a good part of the acceleration, needs no rate."""
    formation = _pushed(0, across, leader__filter_time=tau)
    e = np.array(formation.errors)
    assert e[:, 0].max() == pytest.approx(_free_answer(), rel=0.02)
    for behind in (1, 2):
        on_paper = _known_late(np.array(formation.vehicles[behind - 1].rows), tau)
        if across:
            assert e[:, behind].max() < on_paper.max()
        else:
            assert e[:, behind] == pytest.approx(on_paper, abs=0.004)


@pytest.mark.parametrize(("across", "most"), [(True, (0.09, 0.04)), (False, (0.075, 0.11))])
def test_a_push_stays_with_the_link_of_the_pushed_car(across: bool, most: Place) -> None:
    """Of 0.47 m the links behind see less than a quarter, with a memory of 0.05 s a fortieth."""
    e = np.array(_pushed(0, across).errors).max(axis=0)
    assert (e[1:] < most).all()
    exact = np.array(_pushed(0, across, **EXACT).errors).max(axis=0)
    assert exact[1:].max() < 0.025 * exact[0]


def _points(isolate: bool) -> tuple[np.ndarray, np.ndarray]:
    """Four free points in a chain, the last one pushed: what each leaves its course by, and links are wrong by [m]."""
    edges, n = ((1, 0), (2, 1), (3, 2)), 4
    q, dq, C = ca.SX.sym("q", 3 * n), ca.SX.sym("dq", 3 * n), joint_rows.formation(((1, 0), (2, 1), (3, 2)), n)
    r, still = np.tile([-10.0, 0.0], 3), np.zeros(6)
    value, W, rate, gamma = C(q, dq, r, still, still, [])
    G = (joint_rows.isolated(W, edges) if isolate else W)[:, [c for c in range(3 * n) if c % 3 < 2]]
    found = constraints.multipliers(G, gamma + 2.0 * rate + value)
    law = ca.Function("law", [q, dq], [-G.T @ found.value, value])
    at = np.array([[-10.0 * k, 0.0, 0.0] for k in range(n)]).ravel()
    rate_now, h, away, links = np.zeros(3 * n), 0.01, [], []
    points = np.array([c for c in range(3 * n) if c % 3 < 2])
    first = at.copy()
    for k in range(1000):
        u, e = (np.array(part).ravel() for part in law(at, rate_now))
        acceleration = np.zeros(3 * n)
        acceleration[points] = u
        acceleration[10] += FORCE / MASS if k < 100 else 0.0
        at, rate_now = at + h * rate_now + 0.5 * h**2 * acceleration, rate_now + h * acceleration
        away.append((at - first).reshape(n, 3)[:, 1])
        links.append(np.hypot(e[::2], e[1::2]))
    return np.abs(away).max(axis=0), np.max(links, axis=0)


def test_joint_multipliers_pull_the_leaders_along_and_isolated_ones_do_not() -> None:
    (apart, links), (joint, _) = _points(isolate=True), _points(isolate=False)
    assert apart[:3].max() < 1e-12
    assert apart[3] == pytest.approx(_free_answer(), rel=0.02)
    assert links[:2].max() < 1e-12
    assert joint[0] > 0.2


def test_the_speed_of_the_head_keeps_long_chains_from_swinging_up() -> None:
    """At 1.5 rad/s filtered accelerations of accelerations grow along a chain; the head's own acceleration does not."""
    leader, last = loop.along_x(lambda t: 20.0 + 2.0 * np.sin(1.5 * t) * min(t / 5.0, 1.0), 45.0), {}
    for on in (0.0, 1.0):
        start = [(-12.0 * (k + 1), 0.0, 0.0, 20.0, 0.0) for k in range(6)]
        formation = Formation(leader, start, feedforward__enabled=on, leader__filter_time=0.3)
        for k in range(1250):
            formation.step(((-12.0, 0.0),) * 6, chain=True, feedforward__speed=leader(k * loop.T)[3])
        last[on] = np.array(formation.errors)[750:].max(axis=0)
    assert last[0.0][0] == pytest.approx(last[1.0][0], rel=1e-6)
    assert last[1.0][5] < 0.5 * last[0.0][5]
