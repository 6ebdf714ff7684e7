"""The axes that trail from the leader's hand, against a rod integrated on its own, closed forms and differences."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from fmukit.kernel import Signals
from fmus.controllers.formation import frame
from fmus.controllers.formation.moving import MovingPlace
from scenarios.formation.axes import trailing
from tests.references import trailing_rod

A = 4.0
TIME = np.linspace(0.0, 20.0, 2001)


def weaving(t: float) -> complex:
    """O1 of a leader at some 20 m/s that weaves by 3 m in 8 s."""
    return complex(20.0 * t + 0.2 * t**2, 3.0 * np.sin(2 * np.pi * t / 8.0))


def place(t: float) -> complex:
    """r on its way from (-20, 4) m to (-35, 10) m."""
    tau = np.clip((t - 5.0) / 8.0, 0.0, 1.0)
    return complex(-20, 4) + complex(-15, 6) * tau**3 * (10 - 15 * tau + 6 * tau**2)


def yaw(t: float) -> float:
    return float(np.angle(trailing_rod.rate(weaving, t)))


def hand(t: float) -> complex:
    return complex(weaving(t) + A * np.exp(1j * yaw(t)))


def rod_length(t: float) -> float:
    return max(abs(place(t)), A)


def pair(z: complex) -> np.ndarray:
    return np.array([z.real, z.imag])


def derivatives(f, t: float, h: float = 1e-3) -> MovingPlace:
    """f, f', f'' by central differences of fourth order."""
    v = [np.atleast_1d(np.array(f(t + k * h))) for k in (-2, -1, 0, 1, 2)]
    first = (v[0] - 8 * v[1] + 8 * v[3] - v[4]) / (12 * h)
    second = (-v[0] + 16 * v[1] - 30 * v[2] + 16 * v[3] - v[4]) / (12 * h**2)
    return MovingPlace(v[2], first, second)


def leader(t: float) -> MovingPlace:
    return derivatives(lambda s: [*pair(weaving(s)), yaw(s)], t)


def told(on: float = 1.0) -> Signals:
    return Signals(["hand.distance", "frame.trailing"], ca.DM([A, on]))


def own(away: complex = 0j, psi: float | None = None) -> Signals:
    """A follower that is so far beside the place it has in axes at psi."""
    angle = yaw(0.0) if psi is None else psi
    o1 = pair(hand(0.0) + np.exp(1j * angle) * (place(0.0) + away - A))
    return Signals(["estimate.position.x", "estimate.position.y", "estimate.yaw"], ca.DM([*o1, angle]))


def numbers(moving: MovingPlace) -> list[np.ndarray]:
    return [np.array(ca.DM(part)).ravel() for part in moving]


def test_a_rod_towed_step_by_step_is_the_one_of_the_differential_equation() -> None:
    exact = trailing_rod.angles(hand, rod_length, 0.3, TIME)
    found = trailing(np.array([pair(hand(t)) for t in TIME]), np.array([rod_length(t) for t in TIME]), 0.3)
    np.testing.assert_allclose(found, exact, atol=2e-4)


@pytest.mark.parametrize("yaw", [0.0, 2.0, -3.0])
def test_along_a_straight_piece_the_angle_shrinks_as_along_a_tractrix(yaw: float) -> None:
    """In one step of any length as in many: tan(phi/2) = tan(phi_0/2) exp(-s/l)."""
    course, way, length = 0.5, 30.0, 12.0
    phi = 2 * np.arctan(np.tan((course - yaw) / 2) * np.exp(-way / length))
    end = float(frame.towed(yaw, way * pair(np.exp(1j * course)), length))
    assert np.exp(1j * end) == pytest.approx(np.exp(1j * (course - phi)), abs=1e-12)
    steps = np.array([k * 0.3 * pair(np.exp(1j * course)) for k in range(101)])
    assert trailing(steps, np.full(101, length), yaw)[-1] == pytest.approx(end, abs=1e-9)
    assert float(frame.towed(yaw, np.zeros(2), length)) == yaw


@pytest.mark.parametrize("length", [5.0, 30.0, 80.0])
def test_on_a_circle_the_rod_is_a_chord_of_its_own(length: float) -> None:
    """It lags behind the tangent by asin(l/R), and its other end is on the circle of radius sqrt(R^2 - l^2)."""
    radius, turn = 100.0, np.linspace(0.0, 20 * np.pi, 20001)
    found = trailing(radius * np.stack((np.sin(turn), -np.cos(turn)), -1), np.full(len(turn), length), 0.0)
    assert turn[-1] - found[-1] == pytest.approx(np.arcsin(length / radius), abs=1e-4)


@pytest.mark.parametrize("t", [2.0, 7.0, 9.0, 12.0, 18.0])
def test_its_turning_and_the_motion_of_the_place_are_those_of_differences(t: float) -> None:
    """Also while the place moves outward, the rod with it."""
    h = 2e-3
    near = t + h * np.arange(-2, 3)
    angles = trailing_rod.angles(hand, rod_length, 0.0, np.concatenate(([0.0], near)))[1:]
    state = {"known": 1, "hand": pair(hand(t)), "yaw": angles[2]}
    r = derivatives(lambda s: pair(place(s)), t)
    axes = frame.motion(told(), state, leader(t), r)
    psi, omega, omega_rate = (float(part) for part in axes)
    assert psi == pytest.approx(angles[2])
    assert omega == pytest.approx((angles[0] - 8 * angles[1] + 8 * angles[3] - angles[4]) / (12 * h), abs=1e-5)
    assert omega_rate == pytest.approx((angles[3] - 2 * angles[2] + angles[1]) / h**2, abs=2e-3)
    wanted = numbers(frame.wanted_hand(leader(t), axes, r, A))
    path = [pair(hand(s) + np.exp(1j * a) * place(s)) for s, a in zip(near, angles, strict=True)]
    assert wanted[0] == pytest.approx(path[2], abs=1e-9)
    assert wanted[1] == pytest.approx((path[0] - 8 * path[1] + 8 * path[3] - path[4]) / (12 * h), abs=1e-3)
    assert wanted[2] == pytest.approx((path[3] - 2 * path[2] + path[1]) / h**2, abs=0.05)


def test_without_it_the_axes_are_the_leaders() -> None:
    state = {"known": 1, "hand": np.zeros(2), "yaw": 2.0}
    found = frame.motion(told(0.0), state, leader(3.0), derivatives(lambda s: pair(place(s)), 3.0))
    assert [float(part) for part in found] == [part[2] for part in leader(3.0)]


@pytest.mark.parametrize("wrong", [-0.004, 0.002])
def test_of_a_yaw_angle_heard_a_little_wrong_the_own_place_knows_more(wrong: float) -> None:
    r = derivatives(lambda s: pair(place(s)), 0.0)
    nothing = {"known": 0, "hand": np.zeros(2), "yaw": 0.0}
    begun = frame.follow(told(), own(psi=yaw(0.0) + wrong), nothing, leader(0.0), r, 1)
    assert float(begun["yaw"]) == pytest.approx(yaw(0.0) + wrong, abs=1e-9)


def test_it_begins_along_the_leader_and_waits_while_that_is_silent() -> None:
    """After an outage the rod has been towed along the chord of what it missed."""
    r = derivatives(lambda s: pair(place(s)), 0.0)
    nothing = {"known": 0, "hand": np.zeros(2), "yaw": 0.0}
    begun = frame.follow(told(), own(beside := complex(0.0, 5.0)), nothing, leader(0.0), r, 1)
    assert float(begun["yaw"]) == pytest.approx(yaw(0.0), abs=0.0100001)
    silent = frame.follow(told(), own(beside), begun, leader(1.0), r, 0)
    assert [float(silent["yaw"]), *np.array(ca.DM(silent["hand"])).ravel()] == [float(begun["yaw"]), *pair(hand(0.0))]
    again = frame.follow(told(), own(beside), silent, leader(2.0), r, 1)
    chord = trailing(np.array([pair(hand(0.0)), pair(hand(2.0))]), np.full(2, rod_length(0.0)), float(begun["yaw"]))
    assert float(again["yaw"]) == pytest.approx(chord[-1])
