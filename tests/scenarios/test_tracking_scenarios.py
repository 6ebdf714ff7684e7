"""The scenarios of chapter 4 on the real FMUs, shortened: start, repeatability, seeds, settings, faults."""

import numpy as np
import pytest

import scenarios
from cosim.results.reading import load_results
from cosim.run import Request, run

NAMES = ("high-speed-tracking", "lateral-tracking", "longitudinal-tracking")


def short(name, folder, *assignments, seed=0, stop=1.0):
    request = Request(scenarios.load(name), folder, assignments, seed, stop)
    summary, results = run(request)
    assert summary["status"] == "ok", summary["reason"]
    return summary, results


@pytest.mark.parametrize("name", NAMES)
def test_every_scenario_starts_on_its_reference(name, tmp_path):
    summary, results = short(name, tmp_path)
    assert summary["metrics"]["lateral_error_max"] < 0.02
    assert summary["metrics"]["longitudinal_error_max"] < 0.02
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
    runs = [short(NAMES[0], tmp_path / str(seed), truth, seed=seed)[1] for seed in (1, 2)]
    assert np.array_equal(runs[0]["plant.yaw"], runs[1]["plant.yaw"])
    assert not np.array_equal(runs[0]["imu.gyroscope.z"], runs[1]["imu.gyroscope.z"])


def test_the_start_follows_the_reference(tmp_path):
    changes = [("reference.initial_speed", "20"), ("reference.initial.course", "0.5"), ("reference.initial.x", "100")]
    summary, results = short(NAMES[0], tmp_path, *changes)
    assert results["plant.velocity.x"][0] == pytest.approx(20.0)
    assert results["plant.yaw"][0] == pytest.approx(0.5)
    assert results["filter.estimate.position.x"][0] == pytest.approx(100.0, abs=0.5)
    assert summary["metrics"]["lateral_error_max"] < 0.02


def test_a_trajectory_file_is_followed_from_its_first_row(tmp_path):
    lines = ["time,x,y,course,speed,acceleration,curvature"]
    lines += [f"{t},{50 + 22 * t},-7,0,22,0,0" for t in (0.1 * k for k in range(100))]
    (tmp_path / "road.csv").write_text("\n".join(lines) + "\n")
    file = ("reference.trajectory_file", str(tmp_path / "road.csv"))
    summary, results = short(NAMES[0], tmp_path / "r", file)
    assert results["plant.position.y"][0] == pytest.approx(-7.0)
    assert summary["metrics"]["lateral_error_max"] < 0.02


def test_worse_receivers_estimate_worse(tmp_path):
    errors = [
        short(NAMES[0], tmp_path / name, ("scenario.gps_profile", name), stop=2.0)[0]["metrics"][
            "position_estimate_rms"
        ]
        for name in ("rtk", "standalone")
    ]
    assert errors[1] > 5.0 * errors[0]


def test_an_impossible_parameter_stops_the_run_and_keeps_the_results(tmp_path):
    scenario = scenarios.load(NAMES[0])
    missing = ("reference.trajectory_file", str(tmp_path / "letters.csv"))
    (tmp_path / "letters.csv").write_text(
        "time,x,y,course,speed,acceleration,curvature\n0,0,0,0,20,0,0\n1,a,b,c,d,e,f\n"
    )
    summary, _ = run(Request(scenario, tmp_path / "r", [missing], 0, 0.1))
    assert summary["status"] == "failed"
    assert summary["reason"].startswith("reference failed at 0 s (discard)")
    assert "letters.csv" in summary["reason"]
    assert len(load_results(tmp_path / "r", {}).time) <= 1


@pytest.mark.parametrize("name", NAMES)
def test_the_overview_is_drawn(name, tmp_path):
    _, results = short(name, tmp_path, stop=0.6)
    scenario = scenarios.load(name)
    assert scenario.draw is not None
    scenario.draw(results, tmp_path / "overview.png", scenario.title)
    assert (tmp_path / "overview.png").read_bytes().startswith(b"\x89PNG")
