"""ReferenceTrajectory against quadrature by another route, and against itself through a file."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus.controllers.bus import SAMPLE
from fmus.controllers.reference import COMPONENT
from fmus.controllers.reference.interface import COLUMNS


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return COMPONENT.kernel()


def now(player: Direct, names: tuple[str, ...] = SAMPLE) -> np.ndarray:
    return np.array([player[f"reference.{name}"] for name in names])


def played(player: Direct, period: float, stop: float) -> np.ndarray:
    """Rows of time and the six values, every `period` up to `stop`."""
    rows = []
    for k in range(round(stop / period) + 1):
        player.sample(period)
        rows.append([k * period, *now(player)])
    return np.array(rows)


def sample_at(player: Direct, t: float) -> None:
    """Sample at any time: sample 0 or 1 of a grid of period t."""
    player.samples = 0 if t == 0.0 else 1
    player.sample(t or 1.0)


def smooth_step(x: float) -> float:
    return float(np.polyval([6.0, -15.0, 10.0, 0.0, 0.0, 0.0], np.clip(x, 0.0, 1.0)))


def hump(t: float, a: float, b: float, r: float) -> float:
    return smooth_step((t - a) / r) - smooth_step((t - b + r) / r)


def manoeuvre(t: float, z: np.ndarray) -> list[float]:
    """Rates of (v, course, x, y) of the default manoeuvre."""
    a_x = 2.0 * hump(t, 1.5, 6.0, 0.5) - 3.0 * hump(t, 10.5, 13.5, 0.5)
    weave = [s * hump(t, 2.0 + 2.2 * k, 4.2 + 2.2 * k, 1.0) for k, s in enumerate((1.0, -1.0, -1.0, 1.0))]
    a_y = 4.0 * (sum(weave) + 0.75 * hump(t, 11.0, 15.5, 1.2))
    v, course = z[0], z[1]
    return [a_x, a_y / v, v * np.cos(course), v * np.sin(course)]


def test_manoeuvre_equals_quadrature(kernel: Kernel) -> None:
    rows = played(Direct(COMPONENT, kernel=kernel), 0.5, 17.0)
    exact = solve_ivp(
        manoeuvre, (0.0, 17.0), [25.0, 0.0, 0.0, 0.0], t_eval=rows[:, 0], rtol=1e-11, atol=1e-11, max_step=0.02
    )
    v, course, x, y = exact.y
    np.testing.assert_allclose(rows[:, 1:5], np.column_stack([x, y, course, v]), atol=1e-6)
    assert v.max() == pytest.approx(33.0, abs=1e-6)


def test_lateral_acceleration_is_the_amplitude(kernel: Kernel) -> None:
    rows = played(Direct(COMPONENT, {"amplitude": 5.0}, kernel=kernel), 0.02, 11.0)
    assert np.abs(rows[:, 4] ** 2 * rows[:, 6]).max() == pytest.approx(5.0, abs=1e-3)


def test_longitudinal_and_lateral_parameter_sets(kernel: Kernel) -> None:
    timing = {"acceleration.start": 1.0, "acceleration.end": 6.5, "deceleration.start": 9.0, "deceleration.end": 14.5}
    parameters = {"amplitude": 0.0, "initial_speed": 15.0, "acceleration": 3.0, "deceleration": 3.0, **timing}
    rows = played(Direct(COMPONENT, parameters, kernel=kernel), 0.02, 16.0)
    assert (rows[0, 4], rows[:, 4].max(), rows[-1, 4]) == pytest.approx((15.0, 30.0, 15.0), abs=1e-9)
    assert np.abs(rows[:, 2]).max() == 0.0
    steady = {"initial_speed": 30.0, "acceleration": 0.0, "deceleration": 0.0}
    rows = played(Direct(COMPONENT, steady, kernel=kernel), 0.02, 16.0)
    np.testing.assert_allclose(rows[:, 4], 30.0)
    assert np.ptp(rows[:, 2]) > 5.0


def test_a_car_that_brakes_to_rest_stays(kernel: Kernel) -> None:
    stop = {"amplitude": 0.0, "initial_speed": 5.0, "acceleration": 0.0}
    rows = played(Direct(COMPONENT, stop, kernel=kernel), 0.1, 16.0)
    assert rows[:, 4].min() == 0.0
    assert np.all(rows[rows[:, 4] == 0.0, 5] == 0.0)
    assert np.ptp(rows[-20:, 1]) < 1e-9


def file_from(kernel: Kernel, times: np.ndarray, shift: float = 0.0) -> np.ndarray:
    """A trajectory file of the default manoeuvre at `times`, course wrapped to (-pi, pi] after adding a turn."""
    player, rows = Direct(COMPONENT, {"initial.course": 3.0}, kernel=kernel), []
    for t in times:
        sample_at(player, t)
        x, y, course, *rest = now(player)
        rows.append([t + shift, x, y, np.angle(np.exp(1j * course)), *rest])
    return np.array(rows)


def test_file_at_uneven_times_plays_the_same_path(kernel: Kernel) -> None:
    random = np.random.default_rng(1)
    times = np.concatenate([[0.0], np.cumsum(random.uniform(0.01, 0.06, 450))])
    table = file_from(kernel, times)
    assert np.ptp(table[:, 3]) > 6.0  # it wraps
    original = played(Direct(COMPONENT, {"initial.course": 3.0}, kernel=kernel), 0.047, 15.0)
    copy = played(Direct(COMPONENT, table=table, kernel=kernel), 0.047, 15.0)
    assert table.shape[1] == len(COLUMNS)
    np.testing.assert_allclose(copy[:, 1:3], original[:, 1:3], atol=2e-6)
    np.testing.assert_allclose(copy[:, 3:5], original[:, 3:5], atol=2e-5)
    np.testing.assert_allclose(copy[:, 5], original[:, 5], atol=4e-2)  # linear: h^2/8 times the second derivative
    np.testing.assert_allclose(copy[:, 6], original[:, 6], atol=3e-5)


def test_rows_of_the_file_are_met_exactly(kernel: Kernel) -> None:
    table = file_from(kernel, np.arange(0.0, 12.0, 0.25))
    player = Direct(COMPONENT, table=table, kernel=kernel)
    rows = played(player, 0.25, 11.5)
    np.testing.assert_allclose(rows[:, [1, 2, 4, 5, 6]], table[: len(rows)][:, [1, 2, 4, 5, 6]], atol=1e-9)


def test_position_is_twice_continuously_differentiable(kernel: Kernel) -> None:
    table = file_from(kernel, np.arange(0.0, 12.0, 0.2))
    h = 0.002
    rows = played(Direct(COMPONENT, table=table, kernel=kernel), h, 3.2)
    for column in (1, 2):
        second = np.diff(rows[:, column], 2) / h**2
        assert np.abs(np.diff(second)).max() < 0.25  # m/s2 per 2 ms; a jump of the curvature would show as 1 or more
    speed = np.hypot(*(np.gradient(rows[:, c], h)[1:-1] for c in (1, 2)))
    np.testing.assert_allclose(speed, rows[1:-1, 4], atol=2e-2)


def test_preview_is_the_later_reference(kernel: Kernel) -> None:
    player = Direct(COMPONENT, kernel=kernel)
    seen = []
    for _ in range(900):
        player.sample()
        seen.append(player.y.copy())
    outputs = player.interface.names("output")
    for k, early in ((2, 100), (20, 430), (60, 700)):
        columns = [outputs.index(f"preview[{k}].{name}") for name in SAMPLE]
        later = seen[early + round(k * 0.05 / 0.02)]
        np.testing.assert_allclose(seen[early][columns], later[: len(SAMPLE)], rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("t", [0.0, 20.0])
def test_straight_on_outside_the_table(kernel: Kernel, t: float) -> None:
    table = file_from(kernel, np.arange(3.0, 8.0, 0.05), shift=0.0)
    edge = table[0] if t == 0.0 else table[-1]
    player = Direct(COMPONENT, table=table, kernel=kernel)
    sample_at(player, t)
    x, y, course, v, a, kappa = now(player)
    assert (v, a, kappa) == pytest.approx((edge[4], 0.0, 0.0))
    assert np.exp(1j * course) == pytest.approx(np.exp(1j * edge[3]))
    travelled = edge[4] * (t - edge[0]) * np.array([np.cos(edge[3]), np.sin(edge[3])])
    np.testing.assert_allclose([x, y] - edge[1:3], travelled, atol=1e-9)
    assert player["preview[20].x"] - x == pytest.approx(v * np.cos(course), rel=1e-9)


def test_two_rows_are_enough(kernel: Kernel) -> None:
    table = np.array([[0.0, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0], [1.0, 10.0, 0.0, 0.0, 10.0, 0.0, 0.0]])
    rows = played(Direct(COMPONENT, table=table, kernel=kernel), 0.1, 3.0)
    np.testing.assert_allclose(rows[:, 1], 10.0 * rows[:, 0], atol=1e-12)
