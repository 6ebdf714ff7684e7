"""Unicycle, sensors, filter and radio run together: who reads what at which tick, and how good it is."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from cosim.engine.loader import Loader
from cosim.engine.models import find
from cosim.engine.schedule import Scheme, schedule
from cosim.model.assembly import assemble
from cosim.model.configuration import Configuration
from cosim.model.system import System
from cosim.results.reading import Results
from cosim.results.storage import PARQUET
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.definition import Scenario, Work

SPEED = 20.0
EXACT = {"loss.probability": 0.0} | {f"{name}.noise": 0.0 for name in ("position", "yaw", "velocity", "yaw_rate")}
MOTION = ("position.x", "position.y", "yaw", "velocity.x", "velocity.y", "yaw_rate")
DURATION = 6.0


def system() -> System:
    """A unicycle that weaves, one that follows it, and radios that listen to it; listed against the dataflow."""
    made = System()
    made.add("car2.follower", "AdaptiveFollower", {"formation.x": -12.0})
    made.add("car2.plant", "Unicycle", {"initial.position.x": -12.0, "initial.speed": SPEED})
    made.add("car4.radio", "Radio", {**EXACT, "latency": 0.0, "message_period": 0.02})
    made.add("car3.radio", "Radio", {"loss.probability": 0.0})
    made.add("car2.radio", "Radio", EXACT)
    made.add("car5.radio", "Radio", EXACT)
    made.add("car6.radio", "Radio", {"loss.probability": 0.0})
    made.add("car1.plant", "Unicycle", {"initial.speed": SPEED, "command.speed": SPEED})
    made.add("car1.filter", "NavigationFilter", {"initial.speed": SPEED})
    for sensor, model in (("car1.gps", "GpsReceiver"), ("car1.imu", "Imu")):
        made.add(sensor, model)
        made.connect("car1.plant", sensor, {"truth.": ""})
        made.connect(sensor, "car1.filter")
    for radio in ("car2.radio", "car3.radio", "car6.radio"):
        made.connect("car1.filter", radio, {"message.": "estimate."})
    made.connect("car2.radio", "car2.follower")
    made.connect("car2.plant", "car2.follower", {"estimate.": "", "estimate.yaw_rate": "angular_rate.z"})
    made.connect("car2.follower", "car2.plant")
    made.connect("car2.radio", "car4.radio", {"message.": "leader."})
    made.connect("car1.plant", "car5.radio", {"message.": "", "message.yaw_rate": "angular_rate.z"})
    for k in range(3):
        made.at(1.0 + 1.5 * k, "car1.plant.command.yaw_rate", 0.1 * (-1) ** k)
    made.at(2.0, "car1.plant.command.speed", 21.0)
    return made


WORK = Work(build=lambda _settings, _prepared: system())
SCENARIO = Scenario("radio", "a radio and a unicycle", "", DURATION, module=__name__)


def made_run(folder: Path, seed: int = 3, scheme: Scheme = "multirate") -> Results:
    finished = run(Request(SCENARIO, folder, seed=seed, scheme=scheme))
    assert finished.summary.status == "ok", finished.summary.reason
    return finished.results


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(tmp_path_factory.mktemp("radio"))


@pytest.fixture(scope="module")
def results(folder: Path) -> Results:
    return made_run(folder)


def test_order_is_that_of_the_dataflow() -> None:
    with Loader(find) as loader:
        nodes = assemble(Configuration(system(), loader.faces(system())), 0)
    order = schedule(nodes).sequential
    for last in ("car2.follower", "car4.radio"):
        chain = ["car1.imu", "car1.filter", "car2.radio", last]
        assert [order.index(name) for name in chain] == sorted(order.index(name) for name in chain)
    assert order.index("car1.gps") < order.index("car1.filter") < order.index("car3.radio")
    assert not schedule(nodes).broken


def rows_sent(results: Results, radio: str, late: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """The rows at which a radio has a message, shown `late` [s], and those at which that message was sent."""
    rows = results.instants(radio)
    rows = rows[results[f"{radio}.leader.valid"][rows] > 0.5]
    sent = np.rint((results.time[rows] - results[f"{radio}.leader.age"][rows] - late) * 1000).astype(int)
    return rows, np.searchsorted(np.rint(results.time * 1000).astype(int), sent)


def test_a_message_is_what_the_filter_had_at_that_very_tick(results: Results) -> None:
    rows, sent = rows_sent(results, "car2.radio")
    assert len(rows) > 500
    for name in MOTION:
        received = results[f"car2.radio.leader.{name}"][rows]
        np.testing.assert_allclose(received, results[f"car1.filter.estimate.{name}"][sent], rtol=0, atol=1e-15)
    assert set(np.rint(1000 * results["car2.radio.leader.age"][rows]).astype(int)) == set(range(20, 120, 10))


def test_a_reader_of_the_radio_has_the_message_at_the_tick_it_comes_in(results: Results) -> None:
    """The second radio sends on, every 20 ms and at once, what the first one has then; without it the tick before."""
    rows, sent = rows_sent(results, "car4.radio")
    for name in MOTION:
        passed_on = results[f"car4.radio.leader.{name}"][rows]
        np.testing.assert_allclose(passed_on, results[f"car2.radio.leader.{name}"][sent], rtol=0, atol=1e-15)
    assert np.ptp(results["car4.radio.leader.position.x"][rows]) > 50


def test_a_radio_can_listen_to_the_plant(results: Results) -> None:
    rows, sent = rows_sent(results, "car5.radio")
    outputs = {"yaw_rate": "angular_rate.z"}
    for name in MOTION:
        received = results[f"car5.radio.leader.{name}"][rows]
        truth = results[f"car1.plant.{outputs.get(name, name)}"][sent]
        np.testing.assert_allclose(received, truth, rtol=0, atol=1e-15)


def test_the_filter_follows_the_unicycle(results: Results) -> None:
    """Its sensors fit: after a second the estimate is as good as that of a car with these sensors."""
    rows = results.instants("car1.filter")
    rows = rows[results.time[rows] > 1.0]

    def rms(estimate: str, truth: str) -> float:
        error = results[f"car1.filter.estimate.{estimate}"][rows] - results[f"car1.plant.{truth}"][rows]
        return math.sqrt(float(np.mean(error**2)))

    assert max(rms("position.x", "position.x"), rms("position.y", "position.y")) < 0.05
    assert rms("yaw", "yaw") < 0.01
    assert max(rms("velocity.x", "velocity.x"), rms("velocity.y", "velocity.y")) < 0.1
    assert rms("yaw_rate", "angular_rate.z") < 0.01
    assert np.ptp(results["car1.plant.velocity.x"]) > 0.9
    assert results["car1.filter.fix.refused_count"][-1] == 0


def test_radios_of_one_run_have_errors_of_their_own(results: Results) -> None:
    """Seeds come from the names: two radios of one sender do not err together."""
    rows, sent = rows_sent(results, "car3.radio")
    first = rows[np.diff(sent, prepend=-1) > 0]
    errors = []
    for radio in ("car3.radio", "car6.radio"):
        exact = results["car2.radio.leader.position.x"][first]
        errors.append(results[f"{radio}.leader.position.x"][first] - exact)
    assert all(0.005 < np.std(error) < 0.015 for error in errors)
    assert abs(np.corrcoef(errors[0], errors[1])[0, 1]) < 0.5


def test_same_seed_same_bytes(results: Results, folder: Path, tmp_path: Path) -> None:
    made_run(tmp_path / "again")
    assert (tmp_path / "again" / PARQUET).read_bytes() == (folder / PARQUET).read_bytes()
    other = made_run(tmp_path / "other", seed=4)
    assert not np.array_equal(other["car3.radio.leader.position.x"], results["car3.radio.leader.position.x"])


def test_the_follower_keeps_its_place(results: Results) -> None:
    """12 m behind a leader known by radio only, which jumps by 1 m/s and 0.1 rad/s."""
    error = np.hypot(results["car2.follower.error.x"], results["car2.follower.error.y"])
    assert error[results.time > 1.0].max() < 1.0


def test_exchanging_in_parallel_makes_every_edge_a_delay(tmp_path: Path) -> None:
    """As in most other tools: what a radio received is seen one period of it later, what it took is what was seen."""
    parallel = made_run(tmp_path, scheme="jacobi")
    rows, sent = rows_sent(parallel, "car2.radio", late=0.01)
    for name in MOTION:
        received = parallel[f"car2.radio.leader.{name}"][rows]
        np.testing.assert_allclose(received, parallel[f"car1.filter.estimate.{name}"][sent], rtol=0, atol=1e-15)
    assert len(rows) > 500
