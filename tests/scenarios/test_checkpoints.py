"""Runs that go on from a checkpoint: to the bit, when they were killed, with faults that last, and into branches."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from cosim.command.main import main
from cosim.model.parsing import parse_assignments
from cosim.results.checkpoint import CHECKPOINT
from cosim.results.reading import load_results
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load

EVENTS = """
[[events]]
signal = "filter.gps.position.x"
time = 0.3
noise = 0.5

[[events]]
signal = "filter.gps.position.y"
time = 0.4
until = 1.3
delay = 0.3

[[events]]
signal = "filter.gps.velocity.*"
drop = 0.3

[[events]]
signal = "llc.wheel_speed.fl"
when = "plant.yaw > 0.001"
freeze = true

[[events]]
signal = "plant.body_force.y"
time = 0.8
ramp_to = 1500.0
over = 0.6
"""
NAMES = ["lateral-tracking", "formation-constraint", "double-lane-change"]
LIGHT = {"formation-constraint": ("scenario.plant=unicycle",)}


def called(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr(sys, "argv", ["cosim", *map(str, words)])
    with pytest.raises(SystemExit) as left:
        main()
    return int(left.value.code or 0)


@pytest.mark.parametrize("name", NAMES)
def test_a_run_goes_on_to_the_bit(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ended at 1.2 s, resumed from the checkpoint at 1 s to 1.6 s, in other folders and with faults that last."""
    events = tmp_path / "events.toml"
    events.write_text(EVENTS)
    options = {"assignments": parse_assignments(LIGHT.get(name, ())), "checkpoint": 0.5}
    if name == "lateral-tracking":
        options["event_files"] = [str(events)]
    run(Request(load(name), tmp_path / "begun", stop_time=1.2, **options))
    whole = run(Request(load(name), tmp_path / "whole", stop_time=1.6, **options)).results
    words = ("run", "--resume", tmp_path / "begun", "--stop-time", "1.6", "-o", tmp_path / "on", "--no-report")
    assert called(monkeypatch, *words, "--quiet") == 0
    on = load_results(tmp_path / "on")
    assert on.names == whole.names
    for column in ("time", *whole.names):
        one, other = (r.time if column == "time" else r[column] for r in (whole, on))
        np.testing.assert_array_equal(one, other, err_msg=column)


def killed(folder: Path, after: float) -> None:
    """A run of 3 s that keeps checkpoints, killed so long after its first one."""
    words = ["run", "lateral-tracking", "--stop-time", "3", "--checkpoint", "0.25", "--quiet", "--no-report"]
    command = [sys.executable, "-m", "cosim", *words, "-o", str(folder)]
    process = subprocess.Popen(command)
    try:
        while not (folder / CHECKPOINT).exists():
            assert process.poll() is None
            time.sleep(0.005)
        time.sleep(after)
    finally:
        process.send_signal(signal.SIGKILL)
        process.wait()


@pytest.mark.skipif(os.name == "nt", reason="there is no SIGKILL")
@pytest.mark.parametrize("moments", [3, pytest.param(20, marks=pytest.mark.nightly)])
def test_killed_at_any_moment_it_goes_on_to_the_same_bytes(
    moments: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two of the kills hit the resumed run itself as well."""
    words = ("--stop-time", "3", "--checkpoint", "0.25", "--quiet", "--no-report")
    assert called(monkeypatch, "run", "lateral-tracking", *words, "-o", tmp_path / "whole") == 0
    whole = (tmp_path / "whole" / "results.parquet").read_bytes()
    for k, after in enumerate(np.random.default_rng(7).uniform(0.0, 0.6, moments)):
        folder = tmp_path / f"killed{k}"
        killed(folder, float(after))
        if (folder / "results.parquet").exists():
            continue  # it was faster
        assert called(monkeypatch, "run", "--resume", folder, "--quiet", "--no-report") == 0
        assert (folder / "results.parquet").read_bytes() == whole


def test_a_branch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A push from the checkpoint on, in a folder of its own: the same until then, another run after it."""
    begun, branch = tmp_path / "begun", tmp_path / "branch"
    whole = run(Request(load("lateral-tracking"), begun, stop_time=1.0, checkpoint=0.5)).results
    push = ("--set", "plant.body_force.y=3000")
    assert called(monkeypatch, "run", "--resume", begun, *push, "-o", branch, "--quiet", "--no-report") == 0
    pushed = load_results(branch)
    before = whole.time < 0.5
    np.testing.assert_array_equal(pushed["plant.yaw"][before], whole["plant.yaw"][before])
    assert abs(pushed["plant.yaw"][-1] - whole["plant.yaw"][-1]) > 1e-3


SLOW = """
stop_time = 1.0
[instances.car]
model = "Unicycle"
period = 0.3
parameters = {"initial.speed" = 10.0}
[instances.gps]
model = "GpsReceiver"
period = 0.05
[[connections]]
from = "car"
to = "gps"
names = {"truth." = ""}
[[events]]
signal = "car.command.yaw_rate"
override = 0.3
"""


def test_a_step_that_was_cut_is_no_place_to_go_on_from(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The car's step from 0.9 s ends with the run at 1 s: a checkpoint at 0.95 s would leave out what follows."""
    file = tmp_path / "slow.toml"
    file.write_text(SLOW)
    quiet = ("--quiet", "--no-report")
    assert called(monkeypatch, "run", file, "--checkpoint", "0.05", "-o", tmp_path / "begun", *quiet) == 0
    assert called(monkeypatch, "run", file, "--stop-time", "2", "-o", tmp_path / "whole", *quiet) == 0
    on = ("--resume", tmp_path / "begun", "--stop-time", "2", "-o", tmp_path / "on")
    assert called(monkeypatch, "run", *on, *quiet) == 0
    assert called(monkeypatch, "compare", tmp_path / "whole", tmp_path / "on", "--tolerance", "0") == 0


def test_an_input_that_is_set_only_in_the_branch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It is recorded from the beginning on, with what it held, and the branch can be gone on with at once."""
    file = tmp_path / "slow.toml"
    file.write_text(SLOW)
    quiet = ("--quiet", "--no-report")
    begun, branch, again = (tmp_path / name for name in ("begun", "branch", "again"))
    assert called(monkeypatch, "run", file, "--checkpoint", "0.3", "-o", begun, *quiet) == 0
    new = ("--at", "0.9:car.command.speed=3")
    assert called(monkeypatch, "run", "--resume", begun, *new, "--stop-time", "2", "-o", branch, *quiet) == 0
    assert called(monkeypatch, "run", file, "--stop-time", "2", *new, "-o", tmp_path / "whole", *quiet) == 0
    assert called(monkeypatch, "compare", tmp_path / "whole", branch, "--tolerance", "0") == 0
    assert called(monkeypatch, "run", "--resume", branch, "-o", again, *quiet) == 0
    assert called(monkeypatch, "compare", again, branch, "--tolerance", "0") == 0


def test_another_system_under_the_same_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file, begun = tmp_path / "slow.toml", tmp_path / "begun"
    file.write_text(SLOW)
    assert called(monkeypatch, "run", file, "--checkpoint", "0.3", "-o", begun, "--quiet", "--no-report") == 0
    for old, new in (("override = 0.3", "override = 0.4"), ("= 10.0", "= 11.0"), ("period = 0.3", "period = 0.15")):
        file.write_text(SLOW.replace(old, new))
        on = ("--resume", begun, "--stop-time", "2", "-o", tmp_path / "on")
        assert called(monkeypatch, "run", *on, "--quiet") == 2
        assert "begin anew" in capsys.readouterr().err


def test_mistakes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    begun = tmp_path / "begun"
    run(Request(load("lateral-tracking"), begun, stop_time=0.3, checkpoint=0.1))
    (tmp_path / "empty").mkdir()
    (tmp_path / "damaged").mkdir()
    data = (begun / CHECKPOINT).read_bytes()
    (tmp_path / "damaged" / CHECKPOINT).write_bytes(data[: len(data) // 2])
    before = {file.name: file.read_bytes() for file in begun.iterdir()}
    for words, sentence in (
        (["--resume", tmp_path / "empty"], "has no checkpoint; runs with --checkpoint leave one"),
        (["--resume", tmp_path / "damaged"], "is damaged; begin the run anew"),
        (["lateral-tracking", "--resume", begun], "leave out lateral-tracking"),
        (["--resume", begun, "--set", "plant.body_force.y=1"], "needs a folder of its own"),
        (["--resume", begun, "--set", "plant.mass=1", "-o", tmp_path / "o"], "cannot be set where a run goes on"),
        (["--resume", begun, "--stop-time", "0.1", "-o", tmp_path / "o"], "of 0.2 s; let the run end later"),
        (["--resume", begun, "--at", "0.1:plant.body_force.y=1", "-o", tmp_path / "o"], "cannot be set at 0.1 s"),
        (["--resume", begun, "--isolate", "all"], "a run goes on with its own settings"),
        (["lateral-tracking", "--checkpoint", "0", "-o", tmp_path / "o"], "must be positive"),
        ([], "name a scenario"),
    ):
        assert called(monkeypatch, "run", *words) == 2, words
        assert sentence in capsys.readouterr().err
    assert {file.name: file.read_bytes() for file in begun.iterdir()} == before
