"""Imu: statistics of its errors against their definitions, and the lever arm against a moved point."""

import numpy as np
import pytest
from navigation_truth import T, motion, rotation_matrix, run, truth

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
    lever, h = np.array([0.7, -0.4, 0.3]), 1e-4
    place = {f"imu.position.{axis}": value for axis, value in zip("xyz", lever, strict=True)}
    seen = run(imu[0], truth(), QUIET | place | {"accelerometer.range": 1e3}, kernel=imu[1])

    def velocity_of_place(t):
        velocity, angles, _, omega, *_ = (block.full().ravel() for block in motion()(t))
        R = rotation_matrix(*angles).full()
        return velocity + R @ np.cross(omega, lever), R

    for k in (520, 700, 1130, 2400):
        t = k * T
        acceleration = (velocity_of_place(t + h)[0] - velocity_of_place(t - h)[0]) / (2 * h)
        force = velocity_of_place(t)[1].T @ (acceleration + np.array([0, 0, 9.81]))
        assert np.allclose([seen[f"accelerometer.{axis}"][k] for axis in "xyz"], force, atol=2e-6)
        assert np.allclose([seen[f"gyroscope.{axis}"][k] for axis in "xyz"], motion()(t)[3].full().ravel(), atol=1e-12)


def test_profiles_are_complete_and_named(imu):
    assert set(PROFILES.sets) == {"automotive", "mems", "tactical"}
    assert profile("tactical").keys() == profile("automotive").keys()
    starts = {v.name: v.start for v in imu[0].interface.select("parameter")}
    assert all(starts[name] == value for name, value in profile("automotive").items())
    with pytest.raises(ValueError, match=r"no profile 'military'; choose one of automotive, mems, tactical"):
        profile("military")
