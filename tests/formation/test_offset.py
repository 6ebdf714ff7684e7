"""The smooth change of the wanted place, against the quintic that SciPy finds from its six end conditions."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.interpolate import BPoly

from fmukit.kernel import Parts, block
from fmus.controllers.formation import offset

T, DURATION = 0.02, 6.0


@block(state=offset.STATES, target=2, duration=1)
def step(state: Parts, target: ca.SX, duration: ca.SX) -> tuple[Parts, ca.SX]:
    later = offset.advance(state, target, T, duration)
    return later, ca.horzcat(*offset.value(later))


def _run(targets: list[tuple[float, float]], start: tuple[float, float] = (0.0, 0.0)) -> np.ndarray:
    """(steps, 2, 3): r, r', r'' after every step."""
    state, rows = offset.start(ca.DM(start)), []
    for target in targets:
        state, seen = step(state, target, DURATION)
        rows.append(np.array(seen))
    return np.array(rows)


def test_course_is_the_quintic_of_its_six_end_conditions_and_ends_exactly() -> None:
    rows = _run([(-12.0, 4.0)] * 350)
    times = T * np.arange(1, 351)
    for axis, end in enumerate((-12.0, 4.0)):
        quintic = BPoly.from_derivatives([0.0, DURATION], [[0.0, 0.0, 0.0], [end, 0.0, 0.0]])
        inside = times < DURATION - 1e-9
        for order in range(3):
            assert rows[inside, axis, order] == pytest.approx(quintic(times[inside], nu=order), abs=1e-10)
    assert rows[-1].tolist() == [[-12.0, 0.0, 0.0], [4.0, 0.0, 0.0]]


def test_a_new_target_on_the_way_goes_on_from_the_present_motion() -> None:
    rows = _run([(-12.0, 4.0)] * 130 + [(8.0, -4.0)] * 320)
    times = T * np.arange(1, 451)
    there = rows[129]
    for axis, end in enumerate((8.0, -4.0)):
        quintic = BPoly.from_derivatives([times[129], times[129] + DURATION], [there[axis], [end, 0.0, 0.0]])
        new = (times > times[129]) & (times < times[129] + DURATION - 1e-9)
        for order in range(3):
            assert rows[new, axis, order] == pytest.approx(quintic(times[new], nu=order), abs=1e-9)
    assert rows[-1].tolist() == [[8.0, 0.0, 0.0], [-4.0, 0.0, 0.0]]


def test_position_speed_and_acceleration_are_continuous() -> None:
    rows = _run([(-12.0, 4.0)] * 130 + [(8.0, -4.0)] * 100 + [(0.0, 0.0)] * 400)
    largest = np.abs(np.diff(rows, axis=0)).max(axis=(0, 1))
    jerk = 60 * 30.0 / DURATION**3 + 36 * 8.0 / DURATION**2 + 9 * 5.0 / DURATION  # bound: way 30 m, 8 m/s, 5 m/s2
    assert largest[2] < jerk * T
    assert rows[:, :, 1] == pytest.approx(np.gradient(rows[:, :, 0], T, axis=0), abs=jerk * T)
    assert np.trapezoid(rows[:, 0, 2], dx=T) == pytest.approx(rows[-1, 0, 1] - rows[0, 0, 1], abs=1e-2)


def test_a_target_that_never_rests_is_followed_by_the_stable_filter() -> None:
    targets = [(np.sin(0.3 * T * k), 1.0 + 1e-9 * k) for k in range(3000)]
    rows = _run(targets)
    system = [60.0 / DURATION**3, 36.0 / DURATION**2, 9.0 / DURATION]
    r, lag = np.zeros(3), []
    for target, _ in targets:
        for _ in range(20):
            third = system[0] * (target - r[0]) - system[1] * r[1] - system[2] * r[2]
            r = r + T / 20 * np.array([r[1], r[2], third])
        lag.append(r[0])
    assert rows[:, 0, 0] == pytest.approx(np.array(lag), abs=0.01)
    assert np.roots([1.0, *system[::-1]]).real.max() < 0.0


def test_an_unchanged_target_is_rest() -> None:
    rows = _run([(-12.0, 4.0)] * 10, start=(-12.0, 4.0))
    assert rows.tolist() == [[[-12.0, 0.0, 0.0], [4.0, 0.0, 0.0]]] * 10


@pytest.mark.parametrize("way", [1.0, 24.0, 60.0, 1e5])
def test_far_places_take_longer_so_that_speed_and_acceleration_stay_small(way: float) -> None:
    here, there = offset.start(ca.DM.zeros(2)), ca.DM([0.6 * way, 0.8 * way])
    T_long = float(offset.unhurried(here, there, 6.0, 10.0, 4.0))
    t = np.linspace(0.0, T_long, 20001)
    quintic = BPoly.from_derivatives([0.0, T_long], [[0.0, 0.0, 0.0], [way, 0.0, 0.0]])
    speed, acceleration = (np.abs(quintic(t, nu=order)).max() for order in (1, 2))
    assert speed <= 10.0 * 1.0001
    assert acceleration <= 4.0 * 1.0001
    assert T_long == 6.0 or max(speed / 10.0, acceleration / 4.0) > 0.999
