"""Formations of any size: places from the head's messages keep errors from growing, whatever the topology and law."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from scenario_types import Configured

from cosim.model.parsing import parse_assignments
from cosim.run.request import Request
from cosim.run.running import Finished, run
from cosim.scenario.discovery import load
from scenarios.formation.errors import follower_errors

LAWS = ("formation-adaptive", "formation-constraint")
LIGHT = "scenario.plant=unicycle"
KEPT = 0.30
"""Root mean square [m] of the hand point of every car."""
GROWTH, NOTHING = 1.2, 0.05
"""Of the last car's to the first follower's, where that is above so many m."""


def drive(name: str, folder: Path, *assignments: str, stop: float | None = None, seed: int = 0) -> Finished:
    finished = run(Request(load(name), folder, parse_assignments(assignments), seed, stop))
    assert finished.summary.status == "ok", finished.summary.reason
    return finished


def values(finished: Finished) -> dict[str, float]:
    return {name: metric.value for name, metric in finished.summary.metrics.items()}


def check(metrics: dict[str, float], size: int) -> None:
    """All cars are kept, none met another, and the last is no worse than the first follower."""
    errors = [metrics[f"car{k}.formation_error_rms"] for k in range(2, size + 1)]
    ratio = errors[-1] / errors[0] if errors[0] > NOTHING else math.nan
    print(f"rms {max(errors):.3f} m, max {metrics['formation_error_max']:.3f} m, last to first {ratio:.2f}")
    assert max(errors) <= KEPT
    assert metrics["collision"] == 0.0
    assert not ratio > GROWTH  # nor where there is none


@pytest.mark.parametrize("law", LAWS)
def test_thirteen_cars_are_kept(law: str, tmp_path: Path) -> None:
    """While the head weaves; with places from neighbours the last car swings by metres."""
    cars = (LIGHT, "scenario.vehicles=13")
    check(values(drive(law, tmp_path, *cars, stop=10.0)), 13)


@pytest.mark.nightly
@pytest.mark.parametrize("size", [4, 13, 25, 50])
@pytest.mark.parametrize("topology", ["diamond", "v", "chain"])
@pytest.mark.parametrize("law", LAWS)
def test_any_number_of_cars_is_kept_in_the_whole_manoeuvre(law: str, topology: str, size: int, tmp_path: Path) -> None:
    """A star has the shape of a chain, and seen from the head is the same."""
    cars = (LIGHT, f"scenario.vehicles={size}", f"scenario.topology={topology}")
    check(values(drive(law, tmp_path, *cars)), size)


@pytest.mark.nightly
@pytest.mark.parametrize(("law", "stop"), [("formation-adaptive", 75.0), ("formation-constraint", 65.0)])
def test_changes_of_many_cars_come_to_their_end(law: str, stop: float, tmp_path: Path) -> None:
    """The last one begins at 30 s and takes 30 s to the wedge, 40 s from V to line; runs are shorter by default."""
    finished = drive(law, tmp_path, LIGHT, "scenario.vehicles=25", stop=stop)
    check(values(finished), 25)
    for car in range(2, 26):
        late = follower_errors(finished.results, car, 1)
        far = np.hypot(*late.place[late.time > stop - 1.0].T)
        assert far.max() <= KEPT


@pytest.mark.nightly
@pytest.mark.parametrize("law", LAWS)
def test_thirteen_multibody_cars_are_kept_in_the_whole_manoeuvre(law: str, tmp_path: Path) -> None:
    """With sensors, filters, radio and low-level controllers; four are driven by every run of the tests."""
    check(values(drive(law, tmp_path, "scenario.vehicles=13")), 13)


def said(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [record.getMessage() for record in caplog.records if "errors are expected to grow" in record.getMessage()]


@pytest.mark.parametrize(
    ("name", "assignments", "sentence"),
    [
        (
            "formation-constraint",
            ("scenario.topology=chain",),
            r"along 3 links .* up to 2\.11 per link, since what",
        ),
        (
            "formation-constraint",
            ("scenario.vehicles=13",),
            r"along 4 links .* up to 4\.00 .* 20 m behind a hand of 4",
        ),
        ("formation-adaptive", ("scenario.vehicles=7",), r"along 3 links .*; use scenario\.frame=head, or give"),
        ("platoon", ("scenario.headway=0",), r"along 9 links .*; give more scenario\.headway \(0\.5 s is enough\)"),
    ],
)
def test_growth_that_theory_expects_is_said_with_its_factor(
    name: str, assignments: tuple[str, ...], sentence: str, configured: Configured, caplog: pytest.LogCaptureFixture
) -> None:
    chain = () if name == "platoon" else ("scenario.frame=neighbour",)
    configured(name, LIGHT, *assignments, *chain)
    (text,) = said(caplog)
    assert re.search(sentence, text)


@pytest.mark.parametrize(
    ("name", "assignments"),
    [
        ("formation-constraint", ("scenario.vehicles=50",)),
        ("formation-constraint", ("scenario.frame=neighbour",)),  # a diamond of four: one link
        ("formation-adaptive", ("scenario.topology=chain",)),
        ("platoon", ()),
        ("platoon", ("scenario.headway=0.5",)),
        ("platoon", ("scenario.law=constraint",)),
        ("platoon", ("scenario.headway=0", "scenario.topology=star")),
        ("platoon", ("scenario.headway=0", "scenario.feedforward=on")),
    ],
)
def test_nothing_is_said_where_nothing_grows(
    name: str, assignments: tuple[str, ...], configured: Configured, caplog: pytest.LogCaptureFixture
) -> None:
    configured(name, LIGHT, *assignments)
    assert said(caplog) == []
