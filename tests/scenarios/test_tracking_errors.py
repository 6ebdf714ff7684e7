"""Tracking metrics on a made-up run whose errors are known in closed form."""

import numpy as np
import pyarrow as pa
import pytest

from cosim.results.reading import Facts, Results
from scenarios.shared.panels import footprints
from scenarios.shared.tracking_errors import longest_saturation
from scenarios.tracking.metrics import tracking_metrics

TIME = np.arange(1001) / 1000
COURSE = 0.3


def columns():
    """Straight reference at 20 m/s, updated every 20 ms; the car is 0.2 m left, 0.5 m ahead, 1 m/s fast."""
    held = np.floor(TIME / 0.02 + 1e-9) * 0.02
    ahead, left = np.array([np.cos(COURSE), np.sin(COURSE)]), np.array([-np.sin(COURSE), np.cos(COURSE)])
    place = 20.0 * TIME[:, None] * ahead + 0.5 * ahead + 0.2 * left
    zero = np.zeros_like(TIME)
    fix = np.floor(TIME / 0.1 + 1e-9)
    return {
        "reference.reference.x": 20.0 * held * ahead[0],
        "reference.reference.y": 20.0 * held * ahead[1],
        "reference.reference.course": zero + COURSE + 2.0 * np.pi,
        "reference.reference.speed": zero + 20.0,
        "plant.position.x": place[:, 0],
        "plant.position.y": place[:, 1],
        "plant.velocity.x": zero + 21.0,
        "plant.velocity.y": zero,
        "plant.yaw": zero + COURSE + 0.01,
        "plant.sideslip": zero - 0.03,
        "plant.roll": 0.01 * np.sin(2.0 * np.pi * TIME),
        "plant.pitch": zero,
        "filter.estimate.position.x": place[:, 0] + 0.03,
        "filter.estimate.position.y": place[:, 1] - 0.04,
        "filter.estimate.yaw": zero + COURSE + 0.01 - 2.0 * np.pi + 0.002,
        "filter.nis.heading": fix,
        "filter.nis.position": zero + 2.0,
        "filter.nis.velocity": zero + 1.5,
        "gps.gps.fix_count": fix,
        "llc.saturation.drive": ((TIME > 0.2) & (TIME <= 0.25) | (TIME > 0.5) & (TIME <= 0.8)).astype(float),
        "llc.saturation.steering": zero,
    }


@pytest.fixture
def results():
    periods = {"reference": 0.02, "filter": 0.005, "gps": 0.01, "plant": 0.001, "llc": 0.001}
    return Results(pa.table({"time": TIME, **columns()}), Facts(periods))


def test_errors_are_those_at_the_reference_instants(results):
    metrics = {name: metric.value for name, metric in tracking_metrics(results, None).items()}
    expected = {
        "lateral_error_max": 0.2,
        "lateral_error_rms": 0.2,
        "longitudinal_error_max": 0.5,
        "speed_error_max": 1.0,
        "course_error_max": 0.02,
        "roll_max": 0.01,
        "sideslip_max": 0.03,
        "position_estimate_rms": 0.05,
        "yaw_estimate_rms": 0.002,
        "saturation_longest": 0.3,
    }
    assert {name: metrics[name] for name in expected} == pytest.approx(expected, rel=1e-9)


def test_each_fix_counts_once(results):
    metrics = {name: metric.value for name, metric in tracking_metrics(results, None).items()}
    assert metrics["nis_heading_mean"] == pytest.approx(np.mean(range(1, 10)))
    assert metrics["nis_position_mean"] == pytest.approx(2.0)
    assert metrics["nis_velocity_mean"] == pytest.approx(1.5)


def test_saturation_to_the_very_end():
    table = pa.table({"time": TIME, "llc.saturation.drive": (TIME > 0.6).astype(float)})
    assert longest_saturation(Results(table, Facts({}))) == pytest.approx(0.399)
    assert longest_saturation(Results(pa.table({"time": TIME}), Facts({}))) == 0.0


def test_footprints_turn_with_the_car():
    box = footprints(np.array([10.0]), np.array([5.0]), np.array([np.pi / 2.0]))[0]
    assert np.ptp(box[:, 0]) == pytest.approx(1.8)
    assert np.ptp(box[:, 1]) == pytest.approx(4.5)
    assert box.mean(axis=0) == pytest.approx([10.0, 5.0])
