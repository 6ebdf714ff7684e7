"""Whether disturbances grow along the platoon: without a remedy they do, with headway and in a star they do not."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from cosim.errors import CosimError
from cosim.model.configuration import Configuration
from cosim.model.parsing import parse_assignments
from cosim.results.reading import Results
from cosim.run.request import Request
from cosim.run.running import Finished, run
from cosim.scenario.settings import chosen
from scenarios.formation.errors import errors_of_followers
from scenarios.formation.string_stability import ratio_metrics
from scenarios.platoon import PLATOON
from scenarios.platoon.events import spans
from scenarios.platoon.excitation import PERIOD
from scenarios.platoon.metrics import during, fill_a_period, platoon_metrics
from scenarios.platoon.row import SPEED

Drive = Callable[..., Finished]
Configured = Callable[..., Configuration]
LIGHT = ("scenario.plant=unicycle", "scenario.vehicles=4")
LIGHTEST = ("scenario.plant=unicycle", "scenario.vehicles=3")
ALL_HEARD = ("car*.radio.loss.probability=0",)
"""A message lost while the head brakes hard sets one car back by decimetres, which says nothing of growing."""
CHAIN0 = ("scenario.headway=0",)
STAR = ("scenario.topology=star", "scenario.headway=0")
TOLD = ("scenario.headway=0", "scenario.feedforward=on")
EVERYBODY_HEARS = {STAR: ALL_HEARD, TOLD: (*ALL_HEARD, "car*.broadcast.loss.probability=0")}
PRINTED = 1.15
"""What the ratios of a run itself stay below with these remedies and messages lost; 1.05 is kept by the response."""
BRAKING = spans("braking")["braking"]
MERGE = spans("events")["merge"]


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Drive:
    """drive(assignments..., manoeuvre=, stop=, status="ok"): a run of the platoon with that end."""

    @cache
    def made(
        *assignments: str, manoeuvre: str, stop: float | None = None, seed: int = 0, status: str = "ok"
    ) -> Finished:
        pairs = parse_assignments((*assignments, f"scenario.manoeuvre={manoeuvre}"))
        finished = run(Request(PLATOON, Path(tmp_path_factory.mktemp("platoon")), pairs, seed, stop))
        assert finished.summary.status == status, finished.summary.reason
        return finished

    return made


def values(finished: Finished) -> dict[str, float]:
    return {name: metric.value for name, metric in finished.summary.metrics.items()}


def ratios(metrics: dict[str, float], cars: int) -> dict[str, float]:
    """All string ratios of cars 3 to `cars`; every one is there."""
    names = [f"car{k}.string_ratio_{kind}" for k in range(3, cars + 1) for kind in ("max", "rms")]
    return {name: metrics[name] for name in names}


def greatest(found: dict[str, float]) -> float:
    """The largest that is known; 0 where no error ever rose above the floor of a ratio."""
    return max((value for value in found.values() if not math.isnan(value)), default=0.0)


def test_braking_grows_along_a_chain_without_a_remedy(drive: Drive) -> None:
    metrics = values(drive(*LIGHTEST, *CHAIN0, manoeuvre="braking", stop=BRAKING.end))
    assert min(ratios(metrics, 3).values()) > 1.2
    assert metrics["car2.speed_ratio_max"] > 1.05


def response(drive: Drive, cars: int, *assignments: str, seeds: Sequence[int] = (0,)) -> dict[str, float]:
    """All ratios of a braking, less the noise and with no message lost: these alone make several percent of errors
    that are small or independent. What noise leaves, as it depends on the speed, the mean over `seeds` takes away."""
    hear = EVERYBODY_HEARS[assignments[-2:]]
    gaps = []
    for seed in seeds:
        disturbed, calm = (
            errors_while_braking(drive(*assignments, *hear, manoeuvre=manoeuvre, stop=BRAKING.end, seed=seed))
            for manoeuvre in ("braking", "quiet")
        )
        gaps.append({k: disturbed[k] - calm[k] for k in disturbed})
    found = ratio_metrics({k: np.mean([gap[k] for gap in gaps], axis=0) for k in gaps[0]})
    return ratios({name: metric.value for name, metric in found.items()}, cars)


def errors_while_braking(finished: Finished) -> dict[int, np.ndarray]:
    """z (n, 2) [m] of the followers; the noise of sensors and radios is the same in all runs with the same seed."""
    leaders = finished.plan.configured.prepared.leaders
    errors = errors_of_followers(finished.results, leaders)
    return {k: during(finished.results, e, BRAKING) for k, e in errors.items()}


@pytest.mark.parametrize("remedy", [STAR, TOLD], ids=["star", "the head's speed"])
def test_no_ratio_exceeds_105_percent_in_a_star_or_when_all_know_the_heads_speed(
    drive: Drive, remedy: tuple[str, ...]
) -> None:
    seeds = range(3) if remedy == STAR else (0,)
    assert max(response(drive, 3, *LIGHTEST, *remedy, seeds=seeds).values()) <= 1.05
    metrics = values(drive(*LIGHTEST, *remedy, manoeuvre="braking", stop=BRAKING.end))
    assert max(ratios(metrics, 3).values()) <= PRINTED


def test_a_push_of_one_car_is_not_passed_on_by_constraint_followers(drive: Drive) -> None:
    """6 kN for 1 s on a car of some 1.8 t; those behind keep a headway from it."""
    cars = ("scenario.law=constraint", "scenario.plant=double-track", "scenario.vehicles=4")
    metrics = values(drive(*cars, manoeuvre="push", stop=16.0))
    assert 0.2 < metrics["push_error_max"] < 0.5
    assert metrics["push_error_behind_max"] <= metrics["push_error_max"]
    assert metrics["push_error_ahead_max"] < 0.1
    assert metrics["collision"] == 0.0


def test_with_headway_no_ratio_exceeds_105_percent_and_a_push_and_a_merge_end_well(drive: Drive) -> None:
    finished = drive(*LIGHT, manoeuvre="events")
    metrics, results = values(finished), finished.results
    assert greatest(ratios(metrics, 4)) <= 1.05
    assert max(metrics[f"car{k}.speed_ratio_max"] for k in (2, 3, 4)) <= 1.05
    assert metrics["settling_time"] < 14.0
    assert metrics["push_error_max"] > 2 * metrics["push_error_ahead_max"]
    assert metrics["collision"] == 0.0
    last = [np.array([results[f"car{k}.plant.position.{axis}"][-1] for axis in "xy"]) for k in range(1, 5)]
    gaps = -np.diff(last, axis=0)
    np.testing.assert_allclose(gaps[:, 0], 12.0 + SPEED, atol=0.3)
    np.testing.assert_allclose(gaps[:, 1], 0.0, atol=0.2)
    y, time = results["car2.plant.position.y"], results.time
    assert y[time < MERGE.begin].mean() == pytest.approx(4.0, abs=0.1)


def test_the_merging_car_has_its_gap_before_it_moves_in(drive: Drive) -> None:
    results = drive(*LIGHT, manoeuvre="events").results
    x = [results[f"car{k}.plant.position.x"] for k in (1, 2, 3)]
    inside = np.flatnonzero((results["car2.plant.position.y"] < 3.5) & (results.time > MERGE.begin))[0]
    assert x[0][0] - x[2][0] == pytest.approx(12.0 + SPEED, abs=1e-6)
    assert x[0][inside] - x[2][inside] == pytest.approx(2 * (12.0 + SPEED), abs=1.0)


def test_a_sweep_with_headway_amplifies_at_no_frequency(drive: Drive) -> None:
    metrics = values(drive("scenario.plant=unicycle", "scenario.vehicles=2", manoeuvre="sweep"))
    assert 0.95 < metrics["car2.string_gain_max"] <= 1.01


def test_what_was_not_over_has_no_figure(drive: Drive) -> None:
    metrics = values(drive(*LIGHTEST, manoeuvre="events", stop=1.0))
    assert math.isnan(metrics["car3.string_ratio_max"])
    assert math.isnan(metrics["car2.speed_ratio_max"])
    assert math.isnan(metrics["push_error_max"])


def test_a_sweep_cut_short_or_seen_unevenly_has_no_gains(drive: Drive, caplog: pytest.LogCaptureFixture) -> None:
    metrics = values(drive(*LIGHTEST, manoeuvre="sweep", stop=1.0))
    assert math.isnan(metrics["string_gain_max"])
    assert math.isnan(metrics["error_gain_max"])
    finished = drive("scenario.plant=unicycle", "scenario.vehicles=2", manoeuvre="sweep")
    results, prepared = finished.results, finished.plan.configured.prepared
    for every, known in ((1, True), (5, True), (3, False), (50, False)):
        names = ("time", *results.names)
        table = pa.table({n: (results.time if n == "time" else results[n])[::every] for n in names})
        seen = Results(table, replace(results.facts, stop=None))
        caplog.clear()
        assert math.isfinite(platoon_metrics(seen, prepared)["string_gain_max"].value) == known
        assert len(caplog.records) == (every > 1)


@pytest.mark.parametrize(("step", "known"), [(0.02, True), (0.1, True), (0.06, False), (1.0, False), (70.0, False)])
def test_rows_of_a_sweep_fill_its_period_evenly_and_often(step: float, known: bool) -> None:
    assert fill_a_period(np.arange(80.0 - PERIOD, 80.0 - 1e-6, step)) == known


def test_a_car_alone_is_a_platoon(drive: Drive) -> None:
    metrics = values(drive("scenario.plant=unicycle", "scenario.vehicles=1", manoeuvre="events", stop=25.0))
    for name in ("string_ratio_max", "string_ratio_norm_rms", "speed_ratio_max"):
        assert math.isnan(metrics[name])
    assert math.isnan(metrics["formation_error_max"])
    assert math.isnan(metrics["distance_min"])


def test_nothing_is_said_to_be_planned(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("fmukit.store.cache_folder", lambda: tmp_path)
    caplog.set_level(logging.INFO, "cosim")
    PLATOON.work().prepare(chosen("platoon", PLATOON.settings, []))
    (record,) = caplog.records
    assert record.message.startswith("writing how the head drives in platoon, which later runs find in")


def test_another_trajectory_of_the_head_is_refused(configured: Configured) -> None:
    with pytest.raises(CosimError, match=r"is the manoeuvre of the scenario"):
        configured("platoon", "scenario.manoeuvre=sweep", "car1.reference.trajectory_file=other.csv")


@pytest.mark.parametrize("topology", ["chain", "star"])
@pytest.mark.parametrize("headway", ["0", "1"])
def test_everybody_starts_and_ends_in_the_same_row(topology: str, headway: str, configured: Configured) -> None:
    """Without driving: the offsets of the merge, summed from the head, with the headway each follower adds."""
    found = configured(
        "platoon", f"scenario.topology={topology}", f"scenario.headway={headway}", "scenario.plant=unicycle"
    )
    last = {e.signal: float(e.value) for e in sorted(found.system.events, key=lambda e: e.time)}
    place = {1: (0.0, 0.0)}
    for k in range(2, 11):
        leader = k - 1 if topology == "chain" else 1
        start = [found.number(f"car{k}.follower", f"formation.{axis}") for axis in "xy"]
        offset = [last.get(f"car{k}.follower.formation.{axis}", start[i]) for i, axis in enumerate("xy")]
        place[k] = (place[leader][0] + offset[0] - float(headway) * SPEED, place[leader][1] + offset[1])
    gap = 12.0 + (float(headway) * SPEED if topology == "chain" else 0.0)
    behind = float(headway) * SPEED if topology == "star" else 0.0
    for k in range(2, 11):
        assert place[k] == pytest.approx(((1 - k) * gap - behind, 0.0), abs=1e-6)


@pytest.mark.nightly
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_ten_cars_of_full_stack_with_headway(drive: Drive, seed: int) -> None:
    metrics = values(drive(manoeuvre="braking", stop=BRAKING.end, seed=seed))
    found = ratios(metrics, 10)
    print({name: round(value, 3) for name, value in found.items()})
    assert greatest(found) <= 1.05
    assert metrics["collision"] == 0.0


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("remedy", "most"), [pytest.param(STAR, 1.05, id="star"), pytest.param(TOLD, 1.06, id="the head's speed")]
)
def test_ten_cars_of_full_stack_with_other_remedies(drive: Drive, remedy: tuple[str, ...], most: float) -> None:
    """With the head's speed one car of the ten has 1.051, the mean of three seeds; the study says so."""
    found = response(drive, 10, *remedy, seeds=range(3))
    print({name: round(value, 3) for name, value in found.items()})
    assert max(found.values()) <= most
    metrics = values(drive(*remedy, manoeuvre="braking", stop=BRAKING.end))
    assert max(ratios(metrics, 10).values()) <= PRINTED


@pytest.mark.nightly
def test_ten_cars_of_full_stack_without_a_remedy(drive: Drive) -> None:
    """Errors grow until cars collide, and the run says so."""
    metrics = values(drive(*CHAIN0, manoeuvre="braking", stop=BRAKING.end, status="missed"))
    assert metrics["string_ratio_max"] > 1.3 and metrics["collision"] == 1.0


@pytest.mark.nightly
def test_all_events_with_ten_cars_of_full_stack(drive: Drive) -> None:
    finished = drive(manoeuvre="events")
    metrics, results = values(finished), finished.results
    assert greatest(ratios(metrics, 10)) <= 1.05
    assert metrics["collision"] == 0.0
    assert metrics["push_error_ahead_max"] < 0.05
    same = drive(manoeuvre="events", stop=10.0).results
    rows = same.time < 10.0
    assert all(np.array_equal(same[name][rows], results[name][: rows.sum()]) for name in same.names)


BAD = ("car*.radio.loss.probability=0.3", "car*.radio.latency=0.1")
"""Every third message lost, and all late."""


def check_decay(drive: Drive, cars: int, *assignments: str, seed: int = 0) -> None:
    """No ratio above 1.05, and the last car is no worse than the first follower."""
    metrics = values(drive(*assignments, f"scenario.vehicles={cars}", manoeuvre="braking", stop=BRAKING.end, seed=seed))
    errors = [metrics[f"car{k}.formation_error_rms"] for k in range(2, cars + 1)]
    largest = greatest(ratios(metrics, cars))
    print([round(e, 3) for e in errors], round(largest, 3))
    assert largest <= 1.05
    assert errors[-1] <= 1.05 * max(errors[0], 0.05)
    assert max(metrics[f"car{k}.speed_ratio_max"] for k in range(2, cars + 1)) <= 1.05
    assert metrics["collision"] == 0.0
    assert metrics["led_back_time"] == 0.0


def test_half_of_the_headway_holds_with_rates_that_are_heard(drive: Drive) -> None:
    check_decay(drive, 4, "scenario.plant=unicycle", "scenario.headway=0.5")


@pytest.mark.nightly
@pytest.mark.parametrize("seed", [0, 1])
def test_twenty_cars_bear_late_and_lost_messages(drive: Drive, seed: int) -> None:
    check_decay(drive, 20, "scenario.plant=unicycle", *BAD, seed=seed)
