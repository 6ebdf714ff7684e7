"""Imu: statistics of its errors against their definitions, and the lever arm against a moved point."""

import numpy as np
import pytest
from navigation_truth import T, motion, rotation_matrix, run, straight, truth

from fmukit.direct import Direct
from fmus.sensors.imu.profiles import PROFILES, profile

N = 20000
STILL = {"time": np.arange(N) * T, "truth.specific_force.z": np.full(N, 9.81)}
QUIET = {
    f"{device}.{error}": 0.0
    for device in ("gyroscope", "accelerometer")
    for error in ("noise_density", "turn_on_bias", "bias_walk", "scale_error", "resolution")
}
FAST = {"time": truth()["time"][:50]} | {name: values[:50] for name, values in truth().items()}


@pytest.mark.parametrize("device", ["gyroscope", "accelerometer"])
def test_allan_deviation_of_white_noise(imu, device):
    density = 2e-3
    y = run(imu[0], STILL, QUIET | {f"{device}.noise_density": density, "seed": 5}, kernel=imu[1])[f"{device}.y"]
    for tau in (T, 20 * T, 100 * T):
        means = y.reshape(-1, round(tau / T)).mean(axis=1)
        allan = np.sqrt(0.5 * np.mean(np.diff(means) ** 2))
        assert allan == pytest.approx(density / np.sqrt(tau), rel=4 / np.sqrt(len(means)))


@pytest.mark.parametrize("device", ["gyroscope", "accelerometer"])
def test_bias_walks_with_the_root_of_time(imu, device):
    walk = 3e-3
    y = run(imu[0], STILL, QUIET | {f"{device}.bias_walk": walk, "seed": 6}, kernel=imu[1])[f"{device}.x"]
    for lag in (1, 50):
        steps = y[lag::lag] - y[:-lag:lag]
        assert np.std(steps) == pytest.approx(walk * np.sqrt(lag * T), rel=4 / np.sqrt(2 * len(steps)))


def test_turn_on_bias_and_scale_error_over_many_units(imu):
    spread = QUIET | {"gyroscope.turn_on_bias": 0.02, "accelerometer.scale_error": 0.01}
    force = {"truth.specific_force.z": 10.0}
    units = [Direct(imu[0], spread | {"seed": seed}, force, kernel=imu[1]) for seed in range(400)]
    bias = [unit[f"gyroscope.{axis}"] for unit in units for axis in "xyz"]
    scale = [unit["accelerometer.z"] / 10.0 - 1 for unit in units]
    assert np.std(bias) == pytest.approx(0.02, rel=0.08)
    assert np.std(scale) == pytest.approx(0.01, rel=0.14)
    assert abs(np.mean(bias)) < 4 * 0.02 / np.sqrt(len(bias))


def test_resolution_and_range(imu):
    signals = FAST | {"truth.angular_rate.z": np.linspace(-3, 3, 50)}
    coarse = QUIET | {"gyroscope.resolution": 0.125, "gyroscope.range": 2.0}
    seen = run(imu[0], signals, coarse, kernel=imu[1])["gyroscope.z"]
    assert np.array_equal(seen, np.floor(np.clip(np.linspace(-3, 3, 50), -2, 2) / 0.125 + 0.5) * 0.125)


def test_without_errors_it_measures_the_motion_of_its_own_place(imu):
    """The mean of the specific force over the period before, by quadrature, and the rate at its end."""
    lever, h = np.array([0.7, -0.4, 0.3]), 1e-4
    place = {f"imu.position.{axis}": value for axis, value in zip("xyz", lever, strict=True)}
    seen = run(imu[0], truth(), QUIET | place | {"accelerometer.range": 1e3}, kernel=imu[1])
    nodes, weights = np.polynomial.legendre.leggauss(4)

    def velocity_of_place(t):
        velocity, angles, _, omega, *_ = (block.full().ravel() for block in motion()(t))
        R = rotation_matrix(*angles).full()
        return velocity + R @ np.cross(omega, lever), R

    def force_at(t):
        acceleration = (velocity_of_place(t + h)[0] - velocity_of_place(t - h)[0]) / (2 * h)
        return velocity_of_place(t)[1].T @ (acceleration + np.array([0, 0, 9.81]))

    for k in (520, 700, 1130, 2400):
        t = k * T
        mean = sum(w / 2 * force_at(t - T * (1 - node) / 2) for node, w in zip(nodes, weights, strict=True))
        assert np.allclose([seen[f"accelerometer.{axis}"][k] for axis in "xyz"], mean, atol=1e-4)
        assert np.allclose([seen[f"gyroscope.{axis}"][k] for axis in "xyz"], motion()(t)[3].full().ravel(), atol=1e-12)


def test_readings_add_up_to_the_change_of_speed_where_the_force_jumps(imu):
    """Speed follows steps every 20 ms with a lag of 0.1 s, so its rate jumps; readings before or after the jumps would
    be off by T/2 over the lag, 2.5 %."""
    time = np.arange(401) * T
    command = 25 - 8 * np.floor(time / 0.02 + 1e-6) * 0.02
    signals = straight(time, command, lag=0.1)
    speed, rate = signals["truth.velocity.x"], signals["truth.acceleration.x"]
    seen = run(imu[0], signals, QUIET, kernel=imu[1])["accelerometer.x"]
    assert np.ptp(np.diff(speed)[200:] / T) > 1
    assert np.allclose(np.cumsum(seen[1:]) * T, speed[1:] - speed[0], atol=1e-9)
    assert abs(np.sum(rate[1:] + rate[:-1]) * T / 2 - (speed[-1] - speed[0])) > 0.02 * abs(speed[-1] - speed[0])


@pytest.mark.parametrize("every", [2, 4])
def test_truth_that_a_host_holds_is_averaged_over_the_time_it_was_held(imu, every):
    """Sums of the readings stay right, and no reading is that of a standing car."""
    index = np.arange(len(truth()["time"])) // every * every
    held = {name: values[index] for name, values in truth().items()} | {"time": truth()["time"]}
    seen, fine = (run(imu[0], signals, QUIET, kernel=imu[1])["accelerometer.x"] for signals in (held, truth()))
    assert np.max(np.abs(seen - fine)) < 0.3
    assert np.sum(seen) * T == pytest.approx(np.sum(fine) * T, abs=0.01)


def test_a_car_that_drives_off_after_a_rest_is_not_averaged_over_the_rest(imu):
    speed = np.concatenate([np.zeros(100), 3.0 * T * np.arange(1, 101)])
    rate = np.concatenate([np.zeros(100), np.full(100, 3.0)])
    signals = {"time": np.arange(200) * T, "truth.velocity.x": speed}
    signals |= {"truth.acceleration.x": rate, "truth.specific_force.x": rate}
    seen = run(imu[0], signals, QUIET, kernel=imu[1])["accelerometer.x"]
    assert np.allclose(seen, rate, atol=1e-9)


def test_without_velocities_it_measures_the_mean_of_the_forces_it_is_told(imu):
    """A host that wires forces and rates only."""
    left = ("truth.velocity.", "truth.acceleration.")
    wired = {name: values for name, values in truth().items() if not name.startswith(left)}
    seen, fine = (run(imu[0], signals, QUIET, kernel=imu[1]) for signals in (wired, truth()))
    for axis in "xyz":
        assert np.allclose(seen[f"accelerometer.{axis}"], fine[f"accelerometer.{axis}"], atol=1e-3)


def test_profiles_are_complete_and_named(imu):
    assert set(PROFILES.sets) == {"automotive", "mems", "tactical"}
    assert profile("tactical").keys() == profile("automotive").keys()
    starts = {v.name: v.start for v in imu[0].interface.select("parameter")}
    assert all(starts[name] == value for name, value in profile("automotive").items())
    with pytest.raises(ValueError, match=r"no profile 'military'; choose one of automotive, mems, tactical"):
        profile("military")
