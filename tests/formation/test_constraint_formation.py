"""Formations of ConstraintFollowers: assembling, changing shape, pushes, and what joint multipliers would do."""

from __future__ import annotations

import casadi as ca
import constraint_loop as loop
import numpy as np
import pytest
from scipy.signal import lsim

from fmus.controllers.constraint_follower import constraints

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
        self.followers = [loop.Follower(**p) for _ in start]
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


def _changes(lag: float | None) -> tuple[np.ndarray, Formation]:
    """Errors (samples x 3) of diamond -> line -> wedge on an S-curve, from up to 5.4 m beside the places."""
    away = ((-4.0, 3.0), (3.0, -4.0), (2.0, 5.0))
    start = [(r[0] + d[0], r[1] + d[1], 0.0, 20.0, 0.0) for r, d in zip(DIAMOND, away, strict=True)]
    formation = Formation(loop.s_curve(rate=0.06), start, lag, **EXACT)
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
    assert max(lateral) < 3.5
    assert not any(y["saturation.speed"] + y["saturation.yaw_rate"] for outputs in formation.seen for y in outputs)


@pytest.mark.parametrize(("lag", "most"), [(0.1, 0.155), (0.2, 0.32)])
def test_actuators_that_lag_leave_decimetres(lag: float, most: float) -> None:
    e, _ = _changes(lag)
    assert 0.02 < e[600:].max() < most


def test_a_chain_changes_within_two_centimetres_too() -> None:
    """Each follower derives the acceleration of the one before, which changes its place itself."""
    steps = (((-8.0, 4.0), (0.0, -8.0), (-8.0, 4.0)), ((-8.0, 0.0),) * 3, ((-6.0, 4.0),) * 3)
    start = [(-8.0, 4.0, 0.0, 20.0, 0.0), (-8.0, -4.0, 0.0, 20.0, 0.0), (-16.0, 0.0, 0.0, 20.0, 0.0)]
    formation = Formation(loop.s_curve(rate=0.06), start, **EXACT)
    for k in range(2250):
        formation.step(steps[k * loop.T >= 15.0] if k * loop.T < 30.0 else steps[2], chain=True)
    assert np.array(formation.errors)[600:].max() < 0.02


def _free_answer() -> float:
    """Largest error of e'' + 2 e' + e = F/m for a push of one second."""
    t = np.linspace(0.0, 10.0, 10001)
    return float(np.max(lsim(([1.0], [1.0, 2.0, 1.0]), (t < 1.0) * FORCE / MASS, t)[1]))


@pytest.mark.parametrize("across", [True, False])
def test_a_push_is_felt_by_the_link_that_is_pushed_only(across: bool) -> None:
    start = [(-10.0 * (k + 1), 0.0, 0.0, 20.0, 0.0) for k in range(3)]
    formation = Formation(loop.steady(20.0), start)
    push = (0.0, FORCE / MASS) if across else (-FORCE / MASS, 0.0)
    for k in range(600):
        pushed = {2: push} if 50 <= k < 100 else {}
        formation.step(((-10.0, 0.0),) * 3, chain=True, pushes=pushed)
    e = np.array(formation.errors).max(axis=0)
    assert e[2] == pytest.approx(_free_answer(), rel=0.02)
    assert e[:2].max() < 0.004


def test_the_link_behind_a_pushed_one_feels_what_its_messages_tell_late() -> None:
    start = [(-10.0 * (k + 1), 0.0, 0.0, 20.0, 0.0) for k in range(3)]
    formation = Formation(loop.steady(20.0), start, **EXACT)
    for k in range(600):
        formation.step(((-10.0, 0.0),) * 3, chain=True, pushes={0: (0.0, FORCE / MASS)} if 50 <= k < 100 else {})
    e = np.array(formation.errors).max(axis=0)
    assert e[0] == pytest.approx(_free_answer(), rel=0.02)
    assert e[1:].max() < 0.05 * e[0]


def _points(isolate: bool) -> tuple[np.ndarray, np.ndarray]:
    """Four free points in a chain, the last one pushed: what each leaves its course by, and links are wrong by [m]."""
    edges, n = ((1, 0), (2, 1), (3, 2)), 4
    q, dq, C = ca.SX.sym("q", 3 * n), ca.SX.sym("dq", 3 * n), constraints.formation(((1, 0), (2, 1), (3, 2)), n)
    r, still = np.tile([-10.0, 0.0], 3), np.zeros(6)
    value, W, rate, gamma = C(q, dq, r, still, still, [])
    G = (constraints.isolated(W, edges) if isolate else W)[:, [c for c in range(3 * n) if c % 3 < 2]]
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
