"""Instances in processes of their own: the same results, and a run that outlives whatever happens in them."""

import os
import re
import subprocess
import sys
import time
from ctypes import c_double
from pathlib import Path

import numpy as np
import pytest
from cosim_mocks import scenario_of
from small_c import foreign, variable

from cosim.engine.fmu import FmuSlave, Library
from cosim.engine.isolation.process import Process
from cosim.engine.isolation.proxy import IsolatedSlave
from cosim.engine.slave import Memory
from cosim.errors import CosimError
from cosim.model.face import read_face
from cosim.model.system import System
from cosim.results.reading import load_results
from cosim.run.request import Request
from cosim.run.running import Finished, run
from cosim.scenario.discovery import load
from fmukit.unpacking import unpack
from fmus.supply import file as catalogue_file

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="instances can be isolated on POSIX only")
U, Y = variable("u", 1, "input", start="0"), variable("y", 0, "output")


def ran(
    file: Path, folder: Path, timeout: float = 30.0, stop: float = 1.0, isolate: tuple[str, ...] = ("a",)
) -> Finished:
    """The FMU as the instances a and b, of which a is isolated."""
    system = System()
    for name in "ab":
        system.add(name, str(file))
    scenario = scenario_of("isolated", lambda _settings, _prepared: system, stop_time=stop)
    return run(Request(scenario, folder, isolate=isolate, isolate_timeout=timeout))


def only_in_a(statement: str) -> str:
    return f"if (m->name[0] == 'a' && m->steps++ == 5) {{ {statement} }}"


@pytest.mark.parametrize(
    ("statement", "reason"),
    [
        ("abort();", "a failed at 0.5 s (crash): its process was killed by signal 6 (Aborted) in fmi2DoStep"),
        (
            "*(volatile int *)8 = 1;",
            "a failed at 0.5 s (crash): its process was killed by signal 11 (Segmentation fault) in fmi2DoStep",
        ),
        ("exit(3);", "a failed at 0.5 s (crash): its process ended with status 3 in fmi2DoStep"),
        (
            "for (volatile int i = 0;; ++i) {}",
            "a failed at 0.5 s (no answer): fmi2DoStep did not return within 2 s, so its process was ended; "
            "`--isolate-timeout` gives it longer",
        ),
        ("return 3;", "a failed at 0.5 s (error): the FMU gave no reason"),
    ],
)
def test_what_ends_a_process_is_one_sentence(tmp_path, statement, reason):
    file = foreign(tmp_path / "f.fmu", [U, Y], {"fmi2DoStep": only_in_a(statement) + "m->r[0] = t + h;"})
    finished = ran(file, tmp_path / "out", timeout=2.0)
    assert (finished.summary.status, finished.summary.reason) == ("failed", reason)
    assert load_results(tmp_path / "out")["b.y"].tolist() == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4, 0.5])


@pytest.mark.parametrize(
    ("call", "told"),
    [
        ("fmi2SetReal", "fmi2SetReal"),
        ("fmi2GetReal", "fmi2GetReal"),
        ("fmi2EnterInitializationMode", "fmi2EnterInitializationMode"),
        ("fmi2ExitInitializationMode", "fmi2ExitInitializationMode"),
    ],
)
def test_the_call_in_which_it_ended_is_named(tmp_path, call, told):
    file = foreign(tmp_path / "f.fmu", [U, Y], {call: "abort();"})
    system = System()
    system.add("a", str(file), isolated=True)
    system.connect("a", "a", {"u": "y"})
    finished = run(Request(scenario_of("early", lambda _settings, _prepared: system), tmp_path / "out"))
    assert finished.summary.status == "failed"
    assert finished.summary.reason == (
        f"a failed at initialisation (crash): its process was killed by signal 6 (Aborted) in {told}"
    )


def test_a_library_that_ends_the_process_when_it_is_loaded(tmp_path):
    """As a failed run, whose results are empty: nothing of an earlier run is left beside its summary."""
    loading = "return 0; } __attribute__((constructor)) void go(void) { _exit(7);"
    loading = "return 0; } __attribute__((constructor)) void go(void) { _exit(7);"
    file = foreign(tmp_path / "f.fmu", [U, Y], {"fmi2Terminate": loading})
    finished = ran(file, tmp_path / "out", isolate=("all",))
    assert finished.summary.status == "failed"
    assert finished.summary.reason == (
        "a failed at initialisation (crash): its process ended with status 7 in fmi2Instantiate"
    )
    assert len(finished.results.time) == 0


_EVERY_FILE = "for (int fd = 0; fd < 64; ++fd)"


@pytest.mark.parametrize(
    ("deed", "reason"),
    [
        ("ftruncate(fd, 0);", ""),
        ("close(fd);", "its process ended with status 0 in CALL"),
        (
            'write(fd, "\\x42\\xff\\xff\\xff\\xff", 5);',
            "its process gave an answer that is none in CALL, and was ended",
        ),
        ('write(fd, "\\x40\\4\\0\\0\\0null", 9);', "its process gave an answer that is none in CALL, and was ended"),
    ],
    ids=["shorter files", "closed files", "too long an answer", "no answer at all"],
)
def test_what_it_does_to_every_file_it_has_ends_nobody_else(tmp_path, deed, reason, capfd):
    """The socket and the memory are among them."""
    declared = "extern int ftruncate(int, long), close(int); extern long write(int, const void *, size_t);"
    file = foreign(tmp_path / "f.fmu", [U, Y], {"fmi2DoStep": declared + only_in_a(f"{_EVERY_FILE} {deed}")})
    finished = ran(file, tmp_path / "out", timeout=5.0)
    assert finished.summary.status == ("failed" if reason else "ok")
    told = re.sub("in fmi2(DoStep|GetReal|SetReal)", "in CALL", finished.summary.reason)  # it goes on meanwhile
    assert told == (f"a failed at 0.5 s (crash): {reason}" if reason else "")
    assert "Traceback" not in capfd.readouterr().err


def test_what_it_prints_or_closes_does_no_harm(tmp_path, capfd):
    noisy = 'puts("x{\\"rows\\": 1}"); fflush(stdout); close(0); close(1); m->r[0] = t + h;'
    file = foreign(tmp_path / "f.fmu", [U, Y], {"fmi2DoStep": f"extern int close(int); {noisy}"})
    finished = ran(file, tmp_path / "out", isolate=("all",))
    assert (finished.summary.status, finished.summary.reason) == ("ok", "")
    assert finished.results["a.y"] == pytest.approx(finished.results.time)
    assert capfd.readouterr().out == ""


def test_nothing_is_left_of_it(tmp_path):
    """Also of what it started itself, and though it never comes back."""
    left = tmp_path / "pid"
    daemon = f"""if (!fork()) {{ setsid(); FILE *file = fopen("{left}", "w"); fprintf(file, "%d", getpid());
      fclose(file); sleep(600); }} sleep(1); for (;;) {{}}"""
    declared = "extern int fork(void), setsid(void), getpid(void); extern unsigned sleep(unsigned);"
    file = foreign(tmp_path / "f.fmu", [U, Y], {"fmi2DoStep": declared + only_in_a(daemon)})
    assert ran(file, tmp_path / "out", timeout=2.0).summary.status == "failed"
    for _ in range(500):
        if not Path(f"/proc/{left.read_text()}/cmdline").is_file():
            return
        time.sleep(0.01)
    pytest.fail("the process it started is still there")


@pytest.mark.parametrize("isolate", [("all",), ("a",)])
def test_every_type_and_the_end_come_through(tmp_path, isolate):
    """Texts, whole numbers, Booleans, the FMU's own end of the simulation, its messages."""
    discrete = {"variability": "discrete"}
    ports = [
        variable("word", 0, "output", "String", **discrete),
        variable("on", 2, "output", "Boolean", **discrete),
        variable("n", 0, "output", "Integer", **discrete),
        Y,
    ]
    calls = {
        "fmi2DoStep": "if (++m->steps == 4) return 2; m->r[0] = t + h; m->i[0] -= 2; m->i[2] = !m->i[2];",
        "fmi2GetBooleanStatus": "*v = k == 3;",
        "fmi2GetString": 'static char text[9]; snprintf(text, 9, "n%d", m->i[0]); v[0] = text;',
    }
    file = foreign(tmp_path / "f.fmu", ports, calls)
    plain, isolated = (ran(file, tmp_path / name, isolate=which) for name, which in (("p", ()), ("i", isolate)))
    assert isolated.summary.reason == plain.summary.reason == "a ended the simulation at 0.3 s"
    assert (tmp_path / "p" / "results.parquet").read_bytes() == (tmp_path / "i" / "results.parquet").read_bytes()
    assert isolated.results["a.word"].tolist() == ["n0", "n-2", "n-4", "n-6"]


def test_messages_pass_through(tank, tmp_path):
    system = System()
    system.add("tank", str(tank), {"fail_at": 0.35}, period=0.1, isolated=True)
    finished = run(Request(scenario_of("leaky", lambda _settings, _prepared: system), tmp_path))
    assert finished.summary.reason == "tank failed at 0.3 s (discard): the tank leaks 100%s of its water"


def test_a_scenario_gives_the_same_bytes(tmp_path):
    scenario = load("lateral-tracking")
    for name, isolate in (("plain", ()), ("isolated", ("plant", "f*"))):
        assert run(Request(scenario, tmp_path / name, stop_time=0.5, isolate=isolate)).summary.status != "failed"
    files = [(tmp_path / name / "results.parquet").read_bytes() for name in ("plain", "isolated")]
    assert files[0] == files[1]


def test_an_instance_there_is_none_of(tmp_path, tank):
    with pytest.raises(CosimError, match="unknown instance 'c'"):
        ran(tank, tmp_path, isolate=("c",))
    with pytest.raises(CosimError, match=r"the time-out of isolated instances is -1 s; give 0\.001 to 1e6 s"):
        ran(tank, tmp_path, timeout=-1.0)


def test_patterns_mean_whole_vehicles():
    system = System()
    for name in ("car1.plant", "car2.hlc", "leader"):
        system.add(name, "Model")
    system.isolate("car*")
    assert [name for name, instance in system.instances.items() if instance.isolated] == ["car1.plant", "car2.hlc"]


def test_once_per_process_is_no_limit_for_processes_of_their_own(tmp_path):
    flags = 'canBeInstantiatedOnlyOncePerProcess="true" canHandleVariableCommunicationStepSize="true"'
    file = foreign(tmp_path / "f.fmu", [U, Y], {"fmi2DoStep": "m->r[0] = ++shared;"}, flags=flags)
    with pytest.raises(CosimError, match=r"only once per process, .* or `--isolate b`"):
        ran(file, tmp_path / "out", isolate=())
    results = ran(file, tmp_path / "out", isolate=("b",)).results
    assert results["a.y"].tolist() == results["b.y"].tolist() == list(map(float, range(11)))


def bound(slave, inputs, outputs):
    slave.enter()
    u, y = np.zeros(len(inputs)), np.zeros(len(outputs))
    time_, step = c_double(0.0), c_double(0.005)
    calls = slave.bind(Memory(time_, step, inputs, u, outputs, y))
    slave.leave()
    return calls, u, y, time_


def test_a_state_is_taken_and_put_back(tmp_path):
    """Into another process, of which the rest is the same to the last bit."""
    file = catalogue_file("Imu")
    unpack(file, tmp_path / "fmu")
    library = Library(read_face(tmp_path / "fmu", file), tmp_path / "fmu")
    outputs = ("accelerometer.x", "gyroscope.z")

    def rest(slave, data, calls, y, time_):
        if data:
            slave.restore(data)
        values = []
        for k in range(10, 20):
            time_.value = 0.005 * k
            assert calls.step() == 0
            assert calls.get() == 0
            values.append(y.tolist())
        return values

    found = []
    for make in (lambda: FmuSlave("imu", library), lambda: IsolatedSlave("imu", library, Process(30.0))):
        first, second = make(), make()
        calls, _, y, time_ = bound(first, (), outputs)
        for k in range(10):
            time_.value = 0.005 * k
            calls.step()
            calls.get()
        data = first.save()
        found += [rest(first, b"", calls, y, time_)]
        calls, _, y, time_ = bound(second, (), outputs)
        found += [rest(second, data, calls, y, time_)]
        first.close()
        second.close()
    assert found[0] == found[1] == found[2] == found[3]
    assert len({tuple(row) for row in found[0]}) == 10


_KILLED = """
import sys
sys.path[:0] = [{tests!r}, {root!r}]
from pathlib import Path
from test_cosim_isolation import ran
ran(Path(sys.argv[1]), Path(sys.argv[2]), isolate=("all",), stop=1e6)
"""


def test_a_killed_run_leaves_no_process(tmp_path):
    pid = tmp_path / "pid"
    note = f'if (!m->steps++) {{ FILE *f = fopen("{pid}", "w"); fprintf(f, "%d", getpid()); fclose(f); }}'
    file = foreign(tmp_path / "f.fmu", [U, Y], {"fmi2DoStep": f"extern int getpid(void); {note}"})
    program = _KILLED.format(tests=str(Path(__file__).parent), root=os.getcwd())
    with subprocess.Popen([sys.executable, "-c", program, str(file), str(tmp_path / "out")]) as process:
        while not (pid.exists() and pid.read_text()):
            time.sleep(0.01)
        process.kill()
    for _ in range(500):
        if not Path(f"/proc/{pid.read_text()}/cmdline").is_file():
            return
        time.sleep(0.01)
    pytest.fail("the isolated instance outlives its master")
