"""Outages of the receiver against the strapdown reference, which knows the sensors' true noise."""

import numpy as np
import pytest
from navigation_truth import TYRE, T, run, sensed, suspension, truth, without
from strapdown_run import errors_of, ours, reference, start_values

from fmus.estimator.profiles import profile
from fmus.sensors.gps.profiles import profile as receiver
from fmus.sensors.imu.profiles import profile as unit

LAPS = 4
OUTAGES = ((18.0, 19.0), (24.0, 25.0), (30.0, 33.0), (38.0, 41.0), (47.0, 57.0))


def drive():
    """Swerves of a car whose tyres are 10 % softer than the filter believes."""
    signals = truth(16.0 * LAPS, T, "weave", LAPS)
    return signals | suspension(signals, 0.9 * TYRE)


def mean_squares(seed, gps_profile, imu_profile, chain, signals):
    """Mean squares of the errors (position, velocity of the filter, then of the reference) by length of outage [s]."""
    imu, gps, estimator = chain
    settings = {"gps": receiver(gps_profile), "imu": unit(imu_profile)}
    inertial, held = sensed(seed, imu, gps, settings=settings, signals=signals)
    held, times = without(held, signals["time"], OUTAGES), signals["time"]
    start = {"initial.speed": 25.0} | profile(gps_profile, imu_profile)
    y = run(estimator[0], signals | inertial | held, start, kernel=estimator[1])
    parameters = [start_values(imu[0], settings["imu"]), start_values(gps[0], settings["gps"])]
    found = ours(y), reference(inertial, held, times, *parameters)
    errors = np.hstack([errors_of(each, signals) for each in found])
    lengths = {}
    for begin, end in OUTAGES:
        inside = (times > begin + 0.1) & (times < end)
        lengths.setdefault(round(end - begin), []).append(np.mean(errors[inside] ** 2, axis=0))
    return lengths


def ratios(seeds, gps_profile, imu_profile, chain):
    """RMS of the filter over that of the reference, (position, velocity) by length of outage."""
    signals, gathered = drive(), {}
    for seed in range(seeds):
        for length, squares in mean_squares(seed, gps_profile, imu_profile, chain, signals).items():
            gathered.setdefault(length, []).extend(squares)
    rms = {length: np.sqrt(np.mean(squares, axis=0)) for length, squares in gathered.items()}
    return {length: (value[:2] / value[2:]).tolist() for length, value in rms.items()}


def test_an_outage_costs_no_more_than_the_strapdown_reference(chain):
    for length, found in ratios(2, "rtk", "automotive", chain).items():
        assert max(found) < 1.1, (length, found)


@pytest.mark.nightly
@pytest.mark.parametrize("imu_profile", ["automotive", "tactical", "mems"])
@pytest.mark.parametrize("gps_profile", ["rtk", "dgps", "standalone"])
def test_no_outage_with_any_profile_costs_more_than_the_reference(gps_profile, imu_profile, chain):
    found = ratios(8, gps_profile, imu_profile, chain)
    assert {*found} == {1, 3, 10}
    assert max(max(pair) for pair in found.values()) < 1.1, found
