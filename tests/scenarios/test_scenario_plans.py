"""Plans of scenarios: the same bytes every time, found again, made anew when damaged, errors in one sentence."""

from __future__ import annotations

import logging
import os
from pathlib import Path
from time import time

import numpy as np
import pytest

from cosim.errors import CosimError
from fmus.cars.published import single_track
from fmus.planner.path_road import PathRoad
from fmus.planner.road import double_lane_change
from fmus.planner.vehicle import two_wheel_drive
from scenarios.shared.plans import kept, planned

VEHICLE = two_wheel_drive(single_track())


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr("fmukit.store.cache_folder", lambda: tmp_path)
    return tmp_path


def test_the_same_plan_has_the_same_bytes_wherever_it_is_made(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = planned("lane", VEHICLE, double_lane_change(), 12)
    monkeypatch.setenv("CC", "/nonexistent/compiler")
    monkeypatch.setattr("fmukit.store.cache_folder", lambda: cache / "another")
    second = planned("lane", VEHICLE, double_lane_change(), 12)
    assert first != second
    assert first.name == second.name
    assert first.read_bytes() == second.read_bytes()


def test_a_plan_is_made_once_and_told(cache: Path, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "cosim")
    file = planned("lane", VEHICLE, double_lane_change(), 12)
    assert [record.message.partition(" lane")[0] for record in caplog.records] == ["planning", "planned"]
    assert np.loadtxt(file, delimiter=",", skiprows=1).shape == (121, 7)
    assert planned("lane", VEHICLE, double_lane_change(), 12) == file
    assert len(caplog.records) == 2


def test_another_road_car_or_mesh_is_another_plan(cache: Path) -> None:
    files = {
        planned("lane", VEHICLE, double_lane_change(), 12),
        planned("lane", VEHICLE, double_lane_change(), 13),
        planned("lane", VEHICLE, double_lane_change(transition=6.0), 12),
        planned("lane", two_wheel_drive(single_track(), rear=(-5e3, 4e3)), double_lane_change(), 12),
        planned("lane", two_wheel_drive(single_track(), friction=1.0), double_lane_change(), 12),
    }
    assert len(files) == 5


def test_what_is_damaged_is_made_anew_and_what_is_old_is_removed(cache: Path) -> None:
    made = []

    def make(file: Path) -> None:
        made.append(file)
        file.write_text("a,b\n1,2\n")

    file = kept("x", ["one"], make)
    file.write_text("a,b\n1,3\n")
    old = cache / "trajectory-old"
    old.mkdir()
    os.utime(old, (time() - 40 * 86400,) * 2)
    assert kept("x", ["one"], make) == file
    assert file.read_text() == "a,b\n1,2\n"
    assert len(made) == 2
    assert list(cache.iterdir()) == [file.parent]


def test_a_road_without_a_way_through_is_one_sentence(cache: Path) -> None:
    narrow = PathRoad(np.array([[0.0, 0], [10, 0], [20, 0], [30, 0]]), np.full((4, 2), 0.5))
    with pytest.raises(CosimError, match=r"^lane cannot be planned: the corridor is narrower than the car"):
        planned("lane", VEHICLE, narrow, 12)
    assert not list(cache.rglob("*.csv"))


def test_a_cache_that_cannot_be_written_is_one_sentence(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (cache / "file").write_text("in the way")
    monkeypatch.setattr("fmukit.store.cache_folder", lambda: cache / "file")
    with pytest.raises(CosimError, match=r"^cannot keep the plan of lane: the cache folder .* cannot be written \("):
        planned("lane", VEHICLE, double_lane_change(), 12)


def test_a_disk_that_fills_up_while_the_plan_is_written_is_one_sentence(cache: Path) -> None:
    def full(file: Path) -> None:
        raise OSError(28, "No space left on device", str(file))

    with pytest.raises(CosimError, match=r"^cannot write the plan of x: No space left on device; make room .* TMPDIR"):
        kept("x", ["one"], full)
