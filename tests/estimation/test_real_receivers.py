"""A drive through a town as phones and cheap units see it, and every way in which such fixes fall short.

50 Hz unit with a gyroscope bias of 3 degrees/s, one antenna, 1 Hz, positions 1 s late and velocities 0.3 s older, fixes
lost, poor reception for a while, no travel sensors, unknown heading at rest.
"""

from functools import cache

import numpy as np
import pytest
from navigation_truth import run, truth
from strapdown_run import reference_of_late_fixes, start_values

from fmus.estimator.profiles import profile
from fmus.sensors.gps.profiles import profile as receiver
from fmus.sensors.imu.profiles import profile as unit

BIAS = float(np.deg2rad(3.0))
PHONE = {"dropout.probability": 0.05, "degraded.start": 80.0, "degraded.duration": 15.0, "degraded.factor": 3.0}
WITHOUT_SPRINGS = {"design.tyre_stiffness": 36.4e3, "noise.attitude": 3e-3, "design.payload": 100.0}
"""For a car whose lean only its accelerations tell: 6 degrees per g, and how well that holds."""
RADIUS, TRACK = 0.309, 1.5
BEGUN = 20.0  # s, when the heading has long been told


@cache
def town(step=0.02):
    """The drive every 10 ms, and every `step` with the rear wheels, which roll without slip."""
    fine = {name: v for name, v in truth(150.0, 0.01, "town").items() if not name.startswith("suspension")}
    coarse = {name: values[:: round(step / 0.01)] for name, values in fine.items()}
    speed, rate = coarse["truth.velocity.x"], coarse["truth.angular_rate.z"]
    wheels = {"wheel_speed.rl": speed - TRACK / 2 * rate, "wheel_speed.rr": speed + TRACK / 2 * rate}
    return fine, coarse | {name: values / RADIUS for name, values in wheels.items()}


def readings(seed, imu, gps):
    """Of the unit and of the receiver every 20 ms, and the parameters of both."""
    fine, coarse = town()
    settings = unit("mems") | {"gyroscope.turn_on_bias": BIAS, "sample_period": 0.02}, receiver("phone") | PHONE
    inertial = run(imu[0], coarse, settings[0] | {"seed": 2 * seed}, kernel=imu[1])
    satellite = run(gps[0], fine, settings[1] | {"seed": 2 * seed + 1}, kernel=gps[1])
    parameters = start_values(imu[0], settings[0]), start_values(gps[0], settings[1])
    return inertial, {name: values[::2] for name, values in satellite.items()}, parameters


def estimate(inertial, held, estimator, **settings):
    start = profile("phone", "mems") | {"initial.std.gyroscope_bias": BIAS, "sample_period": 0.02} | WITHOUT_SPRINGS
    chosen = start | {name.replace("__", "."): value for name, value in settings.items()}
    return run(estimator[0], town()[1] | inertial | held, chosen, kernel=estimator[1]) | held


def new_fixes(y):
    times, found = town()[1]["time"], np.flatnonzero(np.diff(y["gps.fix_count"]) > 0) + 1
    return found[times[found] > BEGUN]


def yaw_error(yaw):
    return (yaw - town()[1]["truth.yaw"] + np.pi) % (2 * np.pi) - np.pi


def position_errors(x, y):
    signals = town()[1]
    gap = np.hypot(x - signals["truth.position.x"], y - signals["truth.position.y"])
    return gap[signals["time"] > BEGUN]


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


def check(seeds, chain):
    """Consistent, and not worse than the reference that is told the same."""
    imu, gps, estimator = chain
    later, nis, yaw, ours, theirs = town()[1]["time"] > BEGUN, {"position": [], "velocity": []}, [], [], []
    for seed in seeds:
        inertial, held, parameters = readings(seed, imu, gps)
        y = estimate(inertial, held, estimator)
        assert y["fix.refused_count"][-1] <= 2
        assert not y["fix.refused_long"].any()
        assert abs(np.rad2deg(yaw_error(y["estimate.yaw"])[later])).max() < 3.0
        for name, found in nis.items():
            found.append(y[f"nis.{name}"][new_fixes(y)])
        yaw.append((yaw_error(y["estimate.yaw"]) / y["std.yaw"])[later])
        found = reference_of_late_fixes(inertial, held, town()[1]["time"], *parameters)
        ours.append(position_errors(y["estimate.position.x"], y["estimate.position.y"]))
        theirs.append(position_errors(found[:, 0], found[:, 1]))
    for name, found in nis.items():
        values = np.concatenate(found)
        assert abs(values.mean() - 2) < 3 * 2 / np.sqrt(len(values)), (name, values.mean())
    assert np.mean(np.concatenate(yaw) ** 2) < 1.6
    assert rms(np.concatenate(ours)) <= 1.2 * rms(np.concatenate(theirs))


def test_a_drive_with_a_phone_is_consistent_and_as_good_as_the_reference(chain):
    check([0], chain)


@pytest.mark.nightly
def test_drives_with_phones_are_consistent_and_as_good_as_the_reference(chain):
    check(range(1, 9), chain)


def test_wheels_and_course_make_the_heading_surer(chain):
    imu, gps, estimator = chain
    inertial, held, _ = readings(1, imu, gps)
    later = town()[1]["time"] > BEGUN
    found = {
        "neither": estimate(inertial, held, estimator, course__used=False),
        "course": estimate(inertial, held, estimator),
        "wheels": estimate(inertial, held, estimator, course__used=False, wheels__used=True),
    }
    errors = {name: yaw_error(y["estimate.yaw"])[later] for name, y in found.items()}
    assert rms(errors["neither"]) < np.deg2rad(6.0)  # accelerations alone tell the heading
    for name in ("course", "wheels"):
        assert rms(errors[name]) < 0.5 * rms(errors["neither"])
        assert np.mean((errors[name] / found[name]["std.yaw"][later]) ** 2) < 1.6
    standing = (town()[1]["time"] > 66) & (town()[1]["time"] < 71)
    speed = {name: rms(y["estimate.velocity.x"][standing]) for name, y in found.items()}
    assert speed["wheels"] < 0.8 * speed["course"]


def test_fixes_refused_for_longer_than_a_second_are_told(chain):
    """Positions jump by 300 m for a while, and the filter is patient."""
    imu, gps, estimator = chain
    inertial, held, _ = readings(2, imu, gps)
    jump = (held["gps.time"] > 60) & (held["gps.time"] < 66)
    held["gps.position.x"] = held["gps.position.x"] + 300.0 * jump
    y = estimate(inertial, held, estimator)
    times, long = town()[1]["time"], y["fix.refused_long"] > 0.5
    assert 62 < times[long][0] < 63.2
    assert not long[times > 69].any()
    assert y["fix.refused_for"][long].min() > 1.0
    quiet = y["nis.velocity"][new_fixes(y)]
    assert quiet.max() < 30  # the velocities of these fixes are used


def test_what_a_fix_does_not_have_changes_nothing(chain):
    """Invalid parts may hold anything, and accuracies not told are those assumed."""
    imu, gps, estimator = chain
    inertial, held, _ = readings(3, imu, gps)
    first = estimate(inertial, held, estimator, noise__gps_velocity=0.2, noise__gps_position=1.0)
    lying = held | {"gps.heading": np.full_like(held["gps.heading"], 1.3), "gps.heading_accuracy": held["gps.time"]}
    again = estimate(inertial, lying, estimator, noise__gps_velocity=0.2, noise__gps_position=1.0)
    assert np.array_equal(first["estimate.yaw"], again["estimate.yaw"])
    clear = town()[1]["time"] < 80  # before the reception is poor
    silent = {f"gps.{name}_accuracy": np.zeros_like(held["gps.time"]) for name in ("position", "velocity")}
    third = estimate(inertial, held | silent, estimator, noise__gps_velocity=0.2, noise__gps_position=1.0)
    assert np.allclose(first["estimate.position.x"][clear], third["estimate.position.x"][clear], atol=1e-6)


def test_wheels_that_lock_are_not_believed(chain):
    """For 2 s they say that a moving car stands."""
    imu, gps, estimator = chain
    inertial, held, _ = readings(0, imu, gps)
    signals = town()[1]
    turning = np.abs(signals["time"] - 61.0) > 1.0
    locked = {name: turning * signals[name] for name in ("wheel_speed.rl", "wheel_speed.rr")}
    y = estimate(inertial, held | locked, estimator, wheels__used=True)
    off = np.abs(y["estimate.velocity.x"] - signals["truth.velocity.x"])[signals["time"] > BEGUN]
    assert off.max() < 2.0
    assert y["fix.refused_count"][-1] <= 3


def test_a_part_that_is_too_old_is_no_reason_to_doubt_the_rest(chain):
    """Velocities from beyond the history are told as refused, and the estimate stays what positions make it."""
    imu, gps, estimator = chain
    fine, coarse = town()
    settings = unit("mems") | {"sample_period": 0.02}
    late = receiver("phone") | {"latency": 8.0, "velocity.delay": 1.0}
    inertial = run(imu[0], coarse, settings, kernel=imu[1])
    satellite = run(gps[0], fine, late, kernel=gps[1])
    y = estimate(inertial, {name: values[::2] for name, values in satellite.items()}, estimator)
    assert y["fix.refused_count"][-1] > 100
    later = coarse["time"] > BEGUN
    assert max(y[f"std.velocity.{axis}"][later].max() for axis in "xy") < 20.0
