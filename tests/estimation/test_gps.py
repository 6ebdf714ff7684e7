"""GpsReceiver: statistics, exact latency, outages and the lever arm of its antenna."""

import numpy as np
import pytest
from navigation_truth import T, motion, rotation_matrix, run, truth

from fmukit.direct import Direct
from fmus.sensors.gps.profiles import PROFILES, profile

GRID = 0.010
QUIET = {"position.noise": 0.0, "position.correlated_noise": 0.0, "velocity.noise": 0.0, "heading.noise": 0.0}


def still(duration):
    return {"time": np.arange(round(duration / GRID)) * GRID}


def fixes(y):
    """Indices of the samples that report a new fix."""
    return np.flatnonzero(np.diff(y["gps.fix_count"], prepend=0.0) > 0)


@pytest.mark.parametrize("period, latency", [(0.1, 0.05), (0.1, 0.0), (0.05, 0.3), (0.2, 0.13)])
def test_latency_and_period_are_exact(gps, period, latency):
    settings = QUIET | {"fix_period": period, "latency": latency, "antenna.position.x": 0.0, "antenna.position.z": 0.0}
    y = run(gps[0], truth(), settings, every=2, kernel=gps[1])
    times, position = truth()["time"][::2], truth()["truth.position.x"][::2]
    new = fixes(y)
    assert np.allclose(y["gps.age"][new], latency, atol=1e-9)
    assert np.allclose(times - y["gps.time"], y["gps.age"], atol=1e-9)
    assert np.allclose(np.diff(times[new]), period, atol=1e-9)
    assert times[new[0]] == pytest.approx(latency)
    taken = np.round((times - y["gps.age"]) / GRID).astype(int)[new[0] :]
    assert np.allclose(y["gps.position.x"][new[0] :], position[taken], atol=1e-12)
    assert np.allclose(times[new[0] :] - taken * GRID, y["gps.age"][new[0] :], atol=1e-9)


def test_antenna_moves_as_a_point_of_the_body(gps):
    lever, h = np.array([-0.8, 0.5, 1.1]), 1e-5
    place = {f"antenna.position.{axis}": value for axis, value in zip("xyz", lever, strict=True)}
    y = run(gps[0], truth(), QUIET | place | {"latency": 0.0}, every=2, kernel=gps[1])

    def arm(t):
        return rotation_matrix(*motion()(t)[1].full().ravel()).full() @ lever

    for k in (260, 350, 1200):
        o1 = [truth()[f"truth.position.{axis}"][2 * k] for axis in "xyz"]
        t = 2 * k * T
        velocity = motion()(t)[0].full().ravel() + (arm(t + h) - arm(t - h)) / (2 * h)
        assert np.allclose([y[f"gps.position.{axis}"][k] for axis in "xyz"], o1 + arm(t), atol=1e-9)
        assert np.allclose([y[f"gps.velocity.{axis}"][k] for axis in "xyz"], velocity, atol=1e-7)
        assert y["gps.heading"][k] == pytest.approx(truth()["truth.yaw"][2 * k], abs=1e-12)


def test_white_errors_have_their_standard_deviations(gps):
    settings = {"position.correlated_noise": 0.0, "antenna.baseline": 2.0, "fix_period": 0.05, "seed": 4}
    settings |= {f"antenna.position.{axis}": 0.0 for axis in "xyz"}
    y = run(gps[0], still(150), settings, kernel=gps[1])
    sigma = {"position.x": 0.02, "position.y": 0.02, "position.z": 0.03, "velocity.x": 0.03, "velocity.z": 0.03}
    sigma["heading"] = np.deg2rad(0.2) / 2.0
    for name, expected in sigma.items():
        errors = y[f"gps.{name}"][fixes(y)]
        assert np.std(errors) == pytest.approx(expected, rel=3.5 / np.sqrt(2 * len(errors)))
        assert abs(np.mean(errors * np.roll(errors, 1))) < 4 * expected**2 / np.sqrt(len(errors))


def test_slow_error_is_gauss_markov(gps):
    sigma, tau = 0.5, 0.4
    settings = QUIET | {"position.correlated_noise": sigma, "position.correlation_time": tau, "fix_period": 0.05}
    y = run(gps[0], still(400), settings | {"seed": 8}, kernel=gps[1])
    error = y["gps.position.y"][fixes(y)]
    assert np.std(error) == pytest.approx(sigma, rel=0.1)
    for lag in (4, 8, 16):
        correlation = np.mean(error[lag:] * error[:-lag]) / np.var(error)
        assert correlation == pytest.approx(np.exp(-lag * 0.05 / tau), abs=0.1)


def test_slow_error_starts_in_its_stationary_state(gps):
    settings = QUIET | {"position.correlated_noise": 1.0, "latency": 0.0}
    drawn = []
    for seed in range(150):
        receiver = Direct(gps[0], settings | {"seed": seed}, kernel=gps[1])
        receiver.sample()
        drawn.append(receiver["gps.position.y"])
    assert np.std(drawn) == pytest.approx(1.0, rel=0.2)


def test_outage_holds_the_last_fix_and_says_so(gps):
    y = run(gps[0], truth(), {"outage.start": 4.0, "outage.duration": 2.0}, every=2, kernel=gps[1])
    times = truth()["time"][::2]
    inside = (times > 4.049) & (times < 6.049)
    assert not y["gps.valid"][inside].any()
    assert y["gps.valid"][~inside & (times > 0.049)].all()
    assert np.ptp(y["gps.fix_count"][inside]) == 0
    assert y["gps.age"][inside].max() == pytest.approx(2.14)
    assert np.ptp(y["gps.position.x"][inside]) == 0


def test_dropouts_have_their_share(gps):
    y = run(gps[0], still(200), {"dropout.probability": 0.3, "fix_period": 0.05, "seed": 9}, kernel=gps[1])
    assert y["gps.fix_count"][-1] / 4000 == pytest.approx(0.7, abs=0.025)


def test_profiles(gps):
    assert set(PROFILES.sets) == {"rtk", "dgps", "standalone", "phone"}
    starts = {v.name: v.start for v in gps[0].interface.select("parameter")}
    assert all(starts[name] == value for name, value in profile("rtk").items())
    assert profile("standalone")["position.correlated_noise"] > profile("dgps")["position.correlated_noise"]
    with pytest.raises(ValueError, match="choose one of dgps, phone, rtk, standalone"):
        profile("galileo")
