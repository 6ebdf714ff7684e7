"""The scenarios of chapter 4 on the real FMUs, shortened: start, repeatability, seeds, settings, faults."""

import numpy as np
import pytest

from cosim.results.reading import Facts, load_results
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load

NAMES = ("high-speed-tracking", "lateral-tracking", "longitudinal-tracking")


def short(name, folder, *assignments, seed=0, stop=1.0, status="ok"):
    request = Request(load(name), folder, assignments, seed, stop)
    finished = run(request)
    assert finished.summary.status == status, finished.summary.reason
    return finished


@pytest.mark.parametrize("name", NAMES)
def test_every_scenario_starts_on_its_reference(name, tmp_path):
    finished = short(name, tmp_path)
    summary, results = finished.summary, finished.results
    assert summary.metrics["lateral_error_max"].value < 0.02
    assert summary.metrics["longitudinal_error_max"].value < 0.02
    speed = {"high-speed-tracking": 25.0, "lateral-tracking": 30.0, "longitudinal-tracking": 15.0}[name]
    assert results["plant.velocity.x"][0] == pytest.approx(speed)
    assert results["filter.estimate.velocity.x"][0] == pytest.approx(speed, abs=0.3)


def test_equal_seeds_give_equal_bytes_and_others_do_not(tmp_path):
    for folder, seed in (("a", 1), ("b", 1), ("c", 2)):
        short(NAMES[0], tmp_path / folder, seed=seed)
    a, b, c = ((tmp_path / folder / "results.parquet").read_bytes() for folder in ("a", "b", "c"))
    assert a == b
    assert a != c


def test_true_feedback_hides_the_sensors_from_the_controllers(tmp_path):
    truth = ("scenario.feedback", "truth")
    runs = [short(NAMES[0], tmp_path / str(seed), truth, seed=seed).results for seed in (1, 2)]
    assert np.array_equal(runs[0]["plant.yaw"], runs[1]["plant.yaw"])
    assert not np.array_equal(runs[0]["imu.gyroscope.z"], runs[1]["imu.gyroscope.z"])


def test_the_start_follows_the_reference(tmp_path):
    changes = [("reference.initial_speed", "20"), ("reference.initial.course", "0.5"), ("reference.initial.x", "100")]
    finished = short(NAMES[0], tmp_path, *changes)
    summary, results = finished.summary, finished.results
    assert results["plant.velocity.x"][0] == pytest.approx(20.0)
    assert results["plant.yaw"][0] == pytest.approx(0.5)
    assert results["filter.estimate.position.x"][0] == pytest.approx(100.0, abs=0.5)
    assert summary.metrics["lateral_error_max"].value < 0.02


def test_a_trajectory_file_is_followed_from_its_first_row(tmp_path):
    lines = ["time,x,y,course,speed,acceleration,curvature"]
    lines += [f"{t},{50 + 22 * t},-7,0,22,0,0" for t in (0.1 * k for k in range(100))]
    (tmp_path / "road.csv").write_text("\n".join(lines) + "\n")
    file = ("reference.trajectory_file", str(tmp_path / "road.csv"))
    finished = short(NAMES[0], tmp_path / "r", file)
    summary, results = finished.summary, finished.results
    assert results["plant.position.y"][0] == pytest.approx(-7.0)
    assert summary.metrics["lateral_error_max"].value < 0.02


def test_worse_receivers_estimate_worse(tmp_path):
    """A standalone one begins more than the metre off at which the car has left its path."""
    profiles = [(name, ("scenario.gps_profile", name), end) for name, end in (("rtk", "ok"), ("standalone", "missed"))]
    summaries = [short(NAMES[0], tmp_path / name, which, stop=2.0, status=end).summary for name, which, end in profiles]
    rtk, standalone = (summary.metrics["position_estimate_rms"].value for summary in summaries)
    assert standalone > 5.0 * rtk


def test_a_car_that_tips_over_at_rest_stops_the_run_and_keeps_the_results(tmp_path):
    load_behind = [("plant.payload.mass", "2000"), ("plant.payload.x", "-3")]
    summary = run(Request(load(NAMES[0]), tmp_path / "r", load_behind, 0, 0.1)).summary
    assert summary.status == "failed"
    assert summary.reason.startswith("plant failed at 0 s (discard): initialisation failed")
    assert len(load_results(tmp_path / "r", Facts({})).time) <= 1


@pytest.mark.parametrize("name", NAMES)
def test_the_overview_is_drawn(name, tmp_path):
    short(name, tmp_path, stop=0.6).draw(tmp_path / "overview.png")
    assert (tmp_path / "overview.png").read_bytes().startswith(b"\x89PNG")
