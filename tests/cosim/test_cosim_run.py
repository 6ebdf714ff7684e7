"""A whole run on slaves of lambdas: what is kept when it ends early."""

import os
import signal
import subprocess
import sys
import tempfile
from ctypes import c_double
from pathlib import Path

import numpy as np
import pytest
from cosim_mocks import Mock, face, plan_of, scenario_of

from cosim.command.explain import explanation
from cosim.engine.fmu import FmuSlave, Library
from cosim.engine.slave import Memory
from cosim.errors import CosimError
from cosim.model.face import read_face
from cosim.model.system import System
from cosim.results.reading import Facts, load_results
from cosim.run.claim import claimed
from cosim.run.request import Request
from cosim.run.running import execute, run
from fmukit.unpacking import unpack


def single(folder, step, **options):
    system = System()
    system.add("plant", "Mock")
    mock = Mock(face({}, {"y": "m"}, step=0.001, **options), step)
    return plan_of(system, {"plant": mock}, folder), mock


def test_a_signal_while_loading_ends_the_run_before_its_first_step(tmp_path):
    """Raised inside the code of an FMU, a KeyboardInterrupt would be taken for its fault."""
    plan, mock = single(tmp_path, lambda t, h, u: {"y": t})

    def load():
        os.kill(os.getpid(), signal.SIGINT)
        return {"plant": mock}

    outcome = execute(plan, load)
    assert (outcome.status, outcome.time, mock.steps) == ("interrupted", 0, [])


@pytest.mark.parametrize("kind", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_interrupts_between_ticks_and_keeps_the_results(tmp_path, kind):
    def step(time, length, inputs):
        if time == 0.3:
            os.kill(os.getpid(), kind)
        return {"y": time}

    plan, mock = single(tmp_path, step)
    before = signal.getsignal(kind)
    outcome = execute(plan, lambda: {"plant": mock})
    assert outcome.status == "interrupted"
    assert 0.3 <= outcome.time / 1e9 < 0.4
    assert load_results(tmp_path, Facts({})).time[-1] == outcome.time / 1e9
    assert signal.getsignal(kind) == before


def test_a_second_signal_ends_as_the_first(tmp_path):
    def step(time, length, inputs):
        if time == 0.3:
            os.kill(os.getpid(), signal.SIGINT)
            os.kill(os.getpid(), signal.SIGINT)
        return {"y": time}

    plan, mock = single(tmp_path, step)
    outcome = execute(plan, lambda: {"plant": mock})
    assert outcome.status == "interrupted"
    assert len(load_results(tmp_path, Facts({})).time) > 300


def test_what_is_to_be_ignored_is(tmp_path):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        plan, mock = single(tmp_path, lambda t, h, u: os.kill(os.getpid(), signal.SIGHUP) or {"y": t})
        assert execute(plan, lambda: {"plant": mock}).status == "ok"
    finally:
        signal.signal(signal.SIGHUP, before)


def test_any_name_and_the_users_umask(tank, tmp_path):
    folder = Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff\xfe"))
    system = System()
    system.add("tank", str(tank), period=0.1)
    scenario = scenario_of("odd", lambda _settings, _prepared: system, stop_time=0.5)
    before = os.umask(0o077)
    try:
        assert run(Request(scenario, folder)).summary.status == "ok"
    finally:
        os.umask(before)
    assert {path.stat().st_mode & 0o777 for path in folder.iterdir()} == {0o600}
    assert len(load_results(folder).time) == 6


def test_links_are_never_written_through(tank, tmp_path):
    """What somebody planted in a folder of results leads nowhere."""
    (tmp_path / "kept").write_text("kept")
    folder = tmp_path / "out"
    folder.mkdir()
    for name in ("results.arrows", "results.parquet", "results.partial", "summary.json", "summary.json.partial"):
        (folder / name).symlink_to(tmp_path / "kept")
    system = System()
    system.add("tank", str(tank), period=0.1)
    scenario = scenario_of("linked", lambda _settings, _prepared: system, stop_time=0.5)
    assert run(Request(scenario, folder)).summary.status == "ok"
    assert (tmp_path / "kept").read_text() == "kept"


def test_a_failing_step_keeps_the_rows_before_it(tmp_path):
    plan, mock = single(tmp_path, lambda t, h, u: 3 if t >= 0.5 else {"y": t})
    outcome = execute(plan, lambda: {"plant": mock})
    assert outcome.reason == "plant failed at 0.5 s (error): the FMU gave no reason"
    assert len(load_results(tmp_path, Facts({})).time) == 500


def test_a_failing_initialisation_is_reported(tmp_path):
    plan, mock = single(tmp_path, lambda t, h, u: {})
    mock.refuses, mock.reason = True, "mass must be positive"
    outcome = execute(plan, lambda: {"plant": mock})
    assert (outcome.status, outcome.time) == ("failed", 0)
    assert outcome.reason == "mock failed at initialisation (error): mass must be positive"


def test_progress_is_reported_in_nanoseconds_up_to_the_end(tmp_path):
    plan, mock = single(tmp_path, lambda t, h, u: {"y": t})
    seen = []
    execute(plan, lambda: {"plant": mock}, seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 999_000_000


def test_calls_and_time_are_accounted_per_instance(tmp_path):
    plan, mock = single(tmp_path, lambda t, h, u: {"y": sum(range(1000))})
    outcome = execute(plan, lambda: {"plant": mock})
    assert outcome.calls == {"plant": 1000}
    assert 0 < outcome.times["plant"] < outcome.wall


def test_a_broken_cycle_and_a_conversion_are_explained():
    system = System()
    system.add("slow", "Mock", period=0.1)
    system.add("fast", "Mock", period=0.01)
    system.connect("slow", "fast", {"b": "a"})
    system.connect("fast", "slow", {"x": "y"})
    mocks = {
        "slow": Mock(face({"x": "m"}, {"a": "m"}), lambda t, h, u: {}),
        "fast": Mock(face({"b": "mm"}, {"y": "m"}), lambda t, h, u: {}),
    }
    tables = dict(explanation(plan_of(system, mocks)))
    edges = list(tables["edges"].columns[3].cells)
    assert [text.startswith("delay: a cycle is broken here") for text in edges] == [False, True]
    assert list(tables["unit conversions"].columns[0].cells) == ["slow.a -> fast.b"]
    assert list(tables["unit conversions"].columns[3].cells) == ["1000"]


def test_warnings_at_initialisation_are_passed_on_once_each(tmp_path, caplog):
    system, mocks = System(), {}
    for k in range(6):
        system.add(f"car{k}", "Mock")
        mocks[f"car{k}"] = Mock(face({}, {"y": "m"}, step=0.1), lambda t, h, u: {"y": t})
        mocks[f"car{k}"].reason = "the gain is 5 % too large" if k else ""
    with caplog.at_level("WARNING", "cosim"):
        execute(plan_of(system, mocks, tmp_path), lambda: mocks)
    assert caplog.messages == ["car1, car2, car3 and 2 more: the gain is 5 % too large"]


def test_warnings_of_a_run_that_failed_are_passed_on_too(tmp_path, caplog):
    """But not what is told anyway as the reason."""
    system, mocks = System(), {}
    for name in ("one", "two"):
        system.add(name, "Mock")
        mocks[name] = Mock(face({}, {"y": "m"}, step=0.1), lambda t, h, u: {"y": t})

    def step(time, length, inputs):
        mocks["one"].reason, mocks["two"].reason = "the tyre is hot", "the tank is empty."
        return 3 if time > 0.5 else {"y": time}

    mocks["two"] = Mock(face({}, {"y": "m"}, step=0.1), step)
    with caplog.at_level("WARNING", "cosim"):
        outcome = execute(plan_of(system, mocks, tmp_path), lambda: mocks)
    assert outcome.reason == "two failed at 0.6 s (error): the tank is empty"
    assert caplog.messages == ["one: the tyre is hot"]


def test_two_runs_in_one_process_do_not_see_each_others_messages(tank, tmp_path):
    """Both have an instance of the same name; only one of them has something to complain of."""
    slaves = []
    for name in ("one", "two"):
        unpack(tank, tmp_path / name)
        slaves.append(FmuSlave("tank", Library(read_face(tmp_path / name, tank), tmp_path / name)))
    leaky, sound = slaves
    leaky.set({"fail_at": 0.0})
    for slave in slaves:
        slave.enter()
        slave.leave()
    vector = np.zeros(1)
    calls = [slave.bind(Memory(c_double(0.0), c_double(0.1), (), vector[:0], ("level",), vector)) for slave in slaves]
    assert [each.step() for each in calls] == [2, 0]
    assert (leaky.message(), sound.message()) == ("the tank leaks 100%s of its water", "")
    for slave in slaves:
        slave.close()


def test_fmus_are_unpacked_where_they_can_be_read(tank, tmp_path, monkeypatch):
    """The library of PythonFMU ends the process where the path has an escape other than %20."""
    (tmp_path / "größe#1").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "größe#1"))
    system = System()
    system.add("tank", str(tank), period=0.1)
    scenario = scenario_of("odd", lambda _settings, _prepared: system, stop_time=0.5)
    assert run(Request(scenario, tmp_path / "out")).summary.status == "ok"


def test_one_run_at_a_time_writes_into_a_folder(tmp_path):
    """The second is refused and touches nothing; when the first ends, however it does, the folder is free."""
    program = f"from pathlib import Path; from cosim.run.claim import claimed\nwith claimed(Path({str(tmp_path)!r})):"
    wait = " print(1, flush=True); input()"
    other = subprocess.Popen([sys.executable, "-c", program + wait], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert other.stdout is not None
    other.stdout.readline()
    scenario = scenario_of("second", lambda _settings, _prepared: System(), stop_time=0.5)
    (tmp_path / "results.parquet").write_bytes(b"of the first")
    with pytest.raises(CosimError, match=r"^another run is writing into .*; give this one another folder$"):
        run(Request(scenario, tmp_path))
    assert (tmp_path / "results.parquet").read_bytes() == b"of the first"
    other.kill()
    other.wait()
    with claimed(tmp_path):
        pass
