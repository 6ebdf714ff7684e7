"""The whole filter behind its sensors: consistency, latency, lever arms, outages and outliers. No plant needed."""

import casadi as ca
import numpy as np
import pytest
from navigation_truth import TYRE, T, navigate, navigate_at, run, straight, suspension, truth

from fmukit.direct import Direct
from fmukit.kernel import block
from fmus.estimator.navigation import BELIEF, PACKED, full
from fmus.estimator.profiles import profile
from fmus.sensors.gps.profiles import profile as receiver

SEEDS = 12
ESTIMATED = {
    "position.x": "truth.position.x",
    "position.y": "truth.position.y",
    "yaw": "truth.yaw",
    "velocity.x": "truth.velocity.x",
    "velocity.y": "truth.velocity.y",
    "roll": "truth.roll",
    "pitch": "truth.pitch",
}
PERFECT_IMU = {
    f"{device}.{error}": 0.0
    for device in ("gyroscope", "accelerometer")
    for error in ("noise_density", "turn_on_bias", "bias_walk", "scale_error", "resolution")
}
KNOWN = {"design.payload": 0.0, "initial.std.gyroscope_bias": 0.0, "initial.std.attitude": 1e-4}
"""Of a filter that knows its unit to have no bias and its car to have no load."""
PERFECT_GPS = {"position.noise": 0.0, "position.correlated_noise": 0.0, "velocity.noise": 0.0, "heading.noise": 0.0}


def errors(y, signals=None):
    """Estimate minus truth by name."""
    signals = signals or truth()
    return {name: y[f"estimate.{name}"] - signals[true] for name, true in ESTIMATED.items()}


def new_fixes(y):
    return np.flatnonzero(np.diff(y["gps.fix_count"]) > 0) + 1


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


@pytest.fixture(scope="module")
def runs(chain):
    """Nominal runs; the filter believes the tyres to be 10 % stiffer than they are."""
    signals = truth() | suspension(truth(), 0.9 * TYRE)
    return [navigate(seed, *chain, signals=signals) for seed in range(SEEDS)]


@pytest.mark.parametrize("name, freedom", [("heading", 1), ("position", 2), ("velocity", 2)])
def test_innovations_are_as_large_as_the_filter_believes(runs, name, freedom):
    means = np.array([y[f"nis.{name}"][new_fixes(y)[1:]].mean() for y in runs])
    count = len(new_fixes(runs[0])) - 1
    half = 1.96 * np.sqrt(2 * freedom / count)
    assert abs(means.mean() - freedom) < half / np.sqrt(SEEDS)
    assert np.mean(np.abs(means - freedom) < half) >= 0.85


def test_errors_are_as_large_as_the_filter_believes(runs):
    for name in ("position.x", "position.y", "yaw", "velocity.x", "velocity.y"):
        ratio = np.mean([np.mean((errors(y)[name] / y[f"std.{name}"])[400:] ** 2) for y in runs])
        assert 0.5 < ratio < 1.6, name


def test_errors_are_small(runs):
    limits = {"position.x": 0.02, "position.y": 0.02, "yaw": 0.0015, "velocity.x": 0.015, "velocity.y": 0.05}
    limits |= {"roll": 2e-3, "pitch": 1.5e-3}
    for name, limit in limits.items():
        assert np.mean([rms(errors(y)[name][400:]) for y in runs]) < limit, name


def test_late_fixes_are_used_as_if_they_had_come_in_time(chain):
    """Between the report of a fix and the next fix, a receiver 50 ms late gives what one without latency gives."""
    late, prompt = (navigate(3, *chain, settings={"gps": {"latency": latency}}) for latency in (0.05, 0.0))
    phase = np.round(truth()["time"] / T).astype(int) % 20
    both_know_the_same = (phase >= 10) & (truth()["time"] > 0.05)
    for name in (*(f"estimate.{n}" for n in ESTIMATED), "std.yaw", "std.position.x", "std.velocity.y"):
        gap = np.abs(late[name] - prompt[name])
        assert np.max(gap[both_know_the_same]) < 1e-9, name
    assert np.max(np.abs(late["estimate.yaw"] - prompt["estimate.yaw"])) > 1e-5


def test_longest_latency_costs_accuracy_but_not_consistency(chain):
    y = navigate(5, *chain, settings={"gps": {"latency": 0.3}})
    assert y["fix.refused_count"][-1] <= 3  # taken before the filter's start
    assert y["nis.position"][new_fixes(y)[5:]].mean() == pytest.approx(2, abs=0.4)
    assert rms(errors(y)["position.y"][400:]) < 0.05


def test_lever_arms_vanish_with_perfect_sensors(chain):
    arms = {"imu.position.x": 0.9, "imu.position.y": -0.5, "imu.position.z": 0.4}
    antenna = {"antenna.position.x": -1.2, "antenna.position.y": 0.6, "antenna.position.z": 1.3}
    settings = {"imu": PERFECT_IMU | arms, "gps": PERFECT_GPS | antenna, "filter": arms | antenna | KNOWN}
    e = errors(navigate(1, *chain, settings=settings))
    limits = {"position.x": 1e-3, "position.y": 1e-3, "yaw": 1e-5, "velocity.x": 2e-3, "velocity.y": 2e-3}
    for name, limit in limits.items():
        assert np.max(np.abs(e[name][400:])) < limit, name
    forgotten = settings | {"filter": arms | KNOWN | {"antenna.position.y": 0.0}}
    assert np.max(np.abs(errors(navigate(1, *chain, settings=forgotten))["position.y"][400:])) > 0.1


def test_perfect_sensors_navigate_without_any_fix(chain):
    """16 s of dead reckoning over roll, pitch, turns and braking: the equations have no term missing."""
    settings = {"imu": PERFECT_IMU, "gps": {"outage.duration": 100.0}, "filter": KNOWN | {"noise.gyroscope": 1e-7}}
    y = navigate(1, *chain, settings=settings)
    assert y["fix.used_count"][-1] == 0
    for name in ("position.x", "position.y"):
        assert np.max(np.abs(errors(y)[name])) < 0.05
        assert np.max(np.abs(errors(y)["yaw"])) < 1e-5


def test_an_outage_of_two_seconds_is_survived(chain):
    worst, ratio = [], []
    for seed in range(6):
        y = navigate(seed, *chain, settings={"gps": {"outage.start": 7.0, "outage.duration": 2.0}})
        inside = (truth()["time"] > 7.1) & (truth()["time"] < 9.0)
        e = errors(y)
        worst.append(max(np.max(np.abs(e[f"position.{axis}"][inside])) for axis in "xy"))
        ratio += [np.mean((e[f"position.{axis}"] / y[f"std.position.{axis}"])[inside] ** 2) for axis in "xy"]
        assert y["std.position.y"][1795] > 2 * y["std.position.y"][1395]
        assert rms(e["position.y"][2000:]) < 0.03
        assert y["fix.refused_count"][-1] == 0
    assert max(worst) < 0.35
    assert np.mean(ratio) < 2.5


def test_outliers_are_refused_and_counted(chain):
    imu, gps, estimator = chain
    inertial = run(imu[0], truth(), {"seed": 2}, kernel=imu[1])
    satellite = run(gps[0], truth(), {"seed": 3}, every=2, kernel=gps[1])
    held = {name: np.repeat(values, 2)[: len(truth()["time"])] for name, values in satellite.items()}
    held["gps.position.x"] = held["gps.position.x"] + 5.0 * (held["gps.fix_count"] == 50)
    held["gps.heading"] = held["gps.heading"] + 0.3 * (held["gps.fix_count"] == 70)
    y = run(estimator[0], truth() | inertial | held, {"initial.speed": 25.0}, kernel=estimator[1])
    assert y["fix.refused_count"][-1] == 2
    assert y["fix.used_count"][-1] == 158
    assert np.max(np.abs(errors(y)["position.x"][400:])) < 0.1
    assert np.max(np.abs(errors(y)["yaw"][400:])) < 0.006


def test_a_wrong_start_that_was_trusted_is_recovered_from(chain):
    sure = {"initial.std.position": 0.5, "initial.std.yaw": 0.02, "initial.std.velocity": 0.3}
    lost = navigate(1, *chain, settings={"filter": sure | {"initial.position.x": 80.0, "initial.yaw": 0.5}})
    assert lost["fix.refused_count"][-1] >= 10
    assert rms(errors(lost)["position.x"][800:]) < 0.05
    long = lost["fix.refused_long"] > 0.5
    assert long.any()
    assert lost["fix.refused_for"][long].min() > 1.0
    assert lost["fix.refused_for"][-1] == 0


def test_an_unknown_start_is_decided_by_the_first_fix(chain):
    wrong = {"initial.position.x": -3e3, "initial.position.y": 500.0, "initial.yaw": 2.5, "initial.speed": 0.0}
    y = navigate(1, *chain, settings={"filter": wrong})
    assert y["fix.refused_count"][-1] == 0
    assert abs(errors(y)["position.x"][100]) < 0.2
    assert abs(errors(y)["yaw"][100]) < 0.02
    assert rms(errors(y)["velocity.y"][600:]) < 0.1


@pytest.mark.parametrize("mode", ["dgps", "standalone"])
def test_coarser_receivers_with_matching_assumptions(chain, mode):
    settings = {"gps": receiver(mode), "filter": profile(gps=mode)}
    outcomes = [navigate(seed, *chain, settings=settings) for seed in range(4)]
    nis = np.mean([y["nis.position"][new_fixes(y)].mean() for y in outcomes])
    ratio = np.mean([np.mean((errors(y)["position.y"] / y["std.position.y"]) ** 2) for y in outcomes])
    assert nis == pytest.approx(2, abs=0.25)
    assert ratio < 3.0


def test_roll_and_pitch_come_from_suspension_and_tyres(chain):
    """Of a car known to carry nothing."""
    signals = truth() | suspension(truth(), 0.9 * TYRE)
    outcomes = [navigate(k, *chain, settings={"filter": {"design.payload": 30.0}}, signals=signals) for k in range(4)]
    assert np.max(np.abs(truth()["truth.roll"])) > 0.04
    for y in outcomes:
        assert np.max(np.abs(errors(y)["roll"][400:])) < 0.0025
        assert np.max(np.abs(errors(y)["pitch"][400:])) < 0.0015


def test_roll_and_pitch_are_as_sure_as_they_say_with_any_payload(chain):
    """Loads of up to 300 kg anywhere in the car: their lean on the tyres and their share of the load transfer."""
    rng, squares = np.random.default_rng(7), {"roll": [], "pitch": []}
    for seed in range(10):
        signals = truth() | suspension(
            truth(), TYRE, rng.uniform(0, 300), rng.uniform([-1.6, -0.6, -0.3], [1.2, 0.6, 0.8])
        )
        y = navigate(seed, *chain, signals=signals)
        for name, found in squares.items():
            ratio = (errors(y)[name] / y[f"std.{name}"])[400:]
            found.append(np.mean(ratio**2))
            assert np.max(np.abs(ratio)) < 4
    for name, found in squares.items():
        assert 0.1 < np.mean(found) < 1.5, name  # below 1: most loads are lighter than what the filter reckons with


def test_covariance_stays_positive_definite(chain):
    component, kernel = chain[2]
    signals = truth()
    estimator = Direct(component, {"initial.speed": 25.0}, kernel=kernel)
    feed = [name for name in component.interface.names("input") if name in signals]
    for k in range(800):
        estimator.set({name: signals[name][k] for name in feed} | {"accelerometer.z": 9.81})
        estimator.set({"gps.valid": 1.0, "gps.fix_count": k // 20, "gps.time": 0.005 * (k - k % 20)})
        estimator.set({"gps.position.x": signals["truth.position.x"][k - k % 20], "gps.velocity.x": 25.0})
        estimator.sample()
        if k % 50 == 7:
            P = np.array(full_covariance()(BELIEF.split(ca.DM(estimator.x[: BELIEF.size]))["covariance"]))
            assert np.min(np.linalg.eigvalsh(P)) > 0


def full_covariance():
    return block(packed=PACKED)(full).function


def test_another_sampling_period_gives_the_same_picture(chain):
    imu, gps, estimator = chain
    inertial = run(imu[0], truth(), {"seed": 2, "sample_period": 0.01}, every=2, kernel=imu[1])
    satellite = run(gps[0], truth(), {"seed": 3}, every=2, kernel=gps[1])
    slow = {name: values[::2] for name, values in truth().items()}
    settings = {"initial.speed": 25.0, "sample_period": 0.01}
    y = run(estimator[0], slow | inertial | satellite, settings, kernel=estimator[1])
    assert rms((y["estimate.position.y"] - slow["truth.position.y"])[200:]) < 0.025
    assert (y | satellite)["nis.position"][new_fixes(satellite)].mean() == pytest.approx(2, abs=0.4)


@pytest.mark.parametrize("periods", [(5, 10, 7), (5, 7, 5), (3, 11, 8)])
def test_periods_that_do_not_divide_each_other_stay_consistent(chain, periods):
    """Periods of imu, gps and filter in ms. A fix is then up to a period older than its receiver last said."""
    fine = truth(16.0, 0.001)
    signals = fine | suspension(fine, 0.9 * TYRE)
    for name, freedom in (("heading", 1), ("position", 2), ("velocity", 2)):
        values = np.concatenate([y[f"nis.{name}"][new_fixes(y)] for y in at_periods(chain, periods, signals)])
        assert len(values) > 300
        assert abs(values.mean() - freedom) < 3 * np.sqrt(2 * freedom / len(values)), name


def at_periods(chain, periods, signals):
    return [navigate_at(periods, seed, *chain, signals=signals) for seed in range(2)]


def hard_braking(chain, seeds, left_out=()):
    """NIS of velocity and position, and fixes refused, while a car on a straight brakes with 8 m/s2 from 30 m/s.

    Its command comes every 20 ms and its speed lags by 0.1 s: its acceleration jumps by 1.6 m/s2 each time.
    """
    times = np.arange(2001) * T
    since = np.floor(times / 0.02 + 1e-6) * 0.02
    signals = straight(times, 30 - 8 * np.clip(since - 5, 0, 3), lag=0.1)
    signals = {name: 0 * values if name in left_out else values for name, values in signals.items()}
    settings = {"filter": {"design.tyre_stiffness": 1e12}}
    runs = [navigate(seed, *chain, settings=settings, signals=signals) for seed in seeds]
    late = [k for k in new_fixes(runs[0]) if 5.2 < times[k] < 8.2]
    nis = [np.concatenate([y[f"nis.{name}"][late] for y in runs]) for name in ("velocity", "position")]
    return nis, max(y["fix.refused_count"][-1] for y in runs)


def test_innovations_are_as_believed_while_the_acceleration_jumps(chain):
    nis, refused = hard_braking(chain, range(SEEDS))
    assert refused == 0
    for values in nis:
        assert len(values) >= 300
        assert abs(values.mean() - 2) < 3 * np.sqrt(2 * 2 / len(values))


def test_readings_of_instants_would_miss_a_fortieth_of_the_change_of_speed(chain):
    """Without the velocities a unit averages the forces at both ends of its period: T/2 over the lag is lost."""
    nis, _ = hard_braking(chain, range(2), ("truth.velocity.x", "truth.acceleration.x"))
    assert nis[0].mean() > 4


def test_rates_and_sideslip(runs):
    y, signals = runs[0], truth()
    assert rms(y["estimate.yaw_rate"] - np.gradient(signals["truth.yaw"], T)) < 0.004
    assert rms(y["estimate.roll_rate"] - np.gradient(signals["truth.roll"], T)) < 0.004
    assert rms(y["estimate.pitch_rate"] - np.gradient(signals["truth.pitch"], T)) < 0.004
    slip = np.arctan2(signals["truth.velocity.y"], signals["truth.velocity.x"])
    assert rms((y["estimate.sideslip"] - slip)[400:]) < 0.002


def test_invalid_fixes_and_standing_still_change_nothing_but_the_uncertainty(chain):
    component, kernel = chain[2]
    still = {"accelerometer.z": 9.81, "gps.position.x": 40.0}
    estimator = Direct(component, {}, still, kernel=kernel)
    for k in range(400):
        estimator.set({"gps.fix_count": k // 20, "gps.valid": 0.0})
        estimator.sample()
    assert estimator["fix.used_count"] == 0
    assert abs(estimator["estimate.position.x"]) < 1e-9
    assert estimator["std.position.x"] > 1000


def test_profile_of_the_assumptions_is_the_default():
    starts = profile()
    from fmus.estimator import COMPONENT  # noqa: PLC0415

    declared = {v.name: v.start for v in COMPONENT.interface.select("parameter")}
    assert all(declared[name] == value for name, value in starts.items())
    with pytest.raises(ValueError, match="automotive, mems, tactical"):
        profile(imu="space")


def standalone(seeds, chain, laps):
    """RMS of the position's error per axis and the mean of its square over its variance, once the first fix is in."""
    signals = truth(16.0 * laps, T, "weave", laps)
    settings = {"gps": receiver("standalone"), "filter": profile(gps="standalone")}
    gaps, shares = [], []
    for seed in seeds:
        y = navigate(seed, *chain, settings=settings, signals=signals)
        for name in ("position.x", "position.y"):
            error = errors(y, signals)[name][200:]
            gaps.append(rms(error))
            shares.append(np.mean((error / y[f"std.{name}"][200:]) ** 2))
    return rms(np.array(gaps)), float(np.mean(shares))


def test_the_estimate_begins_with_the_slow_error_of_the_receiver(chain):
    """Over twelve runs it errs by the 1.5 m that the receiver does, and says so."""
    error, share = standalone(range(12), chain, 1)
    assert error == pytest.approx(1.5, rel=0.3)
    assert share == pytest.approx(1.0, abs=0.5)


@pytest.mark.nightly
def test_the_slow_error_of_the_receiver_is_borne_over_its_correlation_time(chain):
    """Four minutes each: twice the correlation time."""
    error, share = standalone(range(6), chain, 15)
    assert error == pytest.approx(1.5, rel=0.3)
    assert share == pytest.approx(1.0, abs=0.5)
