"""Guarded processes: bounded, watched, and ended with all they started, however they try to get away."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from fmukit.guard.ending import Ending, death
from fmukit.guard.guarded import Guarded
from fmukit.guard.keeper import fence, processes
from fmukit.guard.keeper.limits import MIB, Limits
from fmukit.guard.stopwatch import Stopwatch

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="descendants are adopted on Linux only")
DAEMON = """
import os, sys, time
def daemon():
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            open(sys.argv[1], "w").write(str(os.getpid()))
            time.sleep(600)
        os._exit(0)
    while not os.path.exists(sys.argv[1]) or not open(sys.argv[1]).read():
        time.sleep(0.01)
"""


def python(text: str, *arguments: object, **settings: object) -> Guarded:
    command = [sys.executable, "-I", "-S", "-c", text, *map(str, arguments)]
    return Guarded(command, **settings)  # type: ignore[arg-type]


def until(what: Callable[[], object]) -> None:
    for _ in range(2000):
        if what():
            return
        time.sleep(0.01)
    pytest.fail("it did not happen")


def is_gone(pid: int) -> bool:
    process = processes.read(pid)
    return process is None or not process.alive


def finished(guarded: Guarded) -> Ending:
    ending = guarded.wait(60.0)
    assert ending is not None
    return ending


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("pass", 0, "ended with status 0"),
        ("raise SystemExit(3)", 3, "ended with status 3"),
        ("import os; os.abort()", -signal.SIGABRT, "was killed by signal 6 (Aborted)"),
        ("import os; os.kill(os.getpid(), 9)", -signal.SIGKILL, "was killed by signal 9 (Killed)"),
        ("import os; os.kill(0, 9)", -signal.SIGKILL, "was killed by signal 9 (Killed)"),
    ],
)
def test_how_a_command_ends_is_told(text: str, code: int, words: str) -> None:
    with python(text) as guarded:
        ending = finished(guarded)
    assert (ending.code, ending.reason, ending.left) == (code, "", 0)
    assert ending.words(guarded.limits) == words == death(code)


def test_a_command_that_does_not_exist_is_told() -> None:
    with Guarded(["/nowhere/at/all"], stderr=subprocess.PIPE) as guarded:
        assert guarded.stderr is not None
        assert b"/nowhere/at/all cannot be started" in guarded.stderr.read()
        assert finished(guarded).code == 127


def test_what_it_prints_and_reads_goes_through_unchanged() -> None:
    pipes = dict.fromkeys(("stdin", "stdout"), subprocess.PIPE)
    with python("print(input()[::-1])", **pipes) as guarded:
        assert guarded.stdin and guarded.stdout
        guarded.stdin.write(b"abc\n")
        guarded.stdin.close()
        assert guarded.stdout.read() == b"cba\n"


def test_descriptors_are_handed_on_and_end_with_the_command() -> None:
    ours, theirs = os.pipe()
    with python(f"import os; os.write({theirs}, b'here')", pass_fds=(theirs,)) as guarded:
        os.close(theirs)
        with os.fdopen(ours, "rb") as stream:
            assert stream.read() == b"here"
        assert finished(guarded).code == 0


def test_a_daemon_is_ended_with_the_command(tmp_path: Path) -> None:
    with python(DAEMON + "daemon()", tmp_path / "pid") as guarded:
        assert finished(guarded).left == 1
    assert is_gone(int((tmp_path / "pid").read_text()))


def test_the_end_of_the_block_ends_everything(tmp_path: Path) -> None:
    with python(DAEMON + "daemon(); time.sleep(600)", tmp_path / "pid") as guarded:
        until(lambda: (tmp_path / "pid").exists() and (tmp_path / "pid").read_text())
        until(lambda: len(guarded.family()) == 2)
        assert guarded.poll() is None
    ending = guarded.end()
    assert (ending.code, ending.reason, ending.left) == (-signal.SIGKILL, "owner", 1)
    assert is_gone(int((tmp_path / "pid").read_text()))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1])
def test_signals_do_not_end_the_keeper(number: int) -> None:
    with python(f"import os, time; os.kill(os.getppid(), {number}); time.sleep(0.1); raise SystemExit(5)") as guarded:
        assert (finished(guarded).code, guarded.end().reason) == (5, "")


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_who_ends_or_stops_its_keeper_is_ended_all_the_same(number: int, tmp_path: Path) -> None:
    deed = f"import os, time; daemon(); os.kill(os.getppid(), {number}); time.sleep(600)"
    with python(DAEMON + deed, tmp_path / "pid") as guarded:
        until(lambda: (tmp_path / "pid").exists() and (tmp_path / "pid").read_text())
        ending = finished(guarded) if number == signal.SIGKILL else guarded.end()
    assert ending.reason == ("keeper" if number == signal.SIGKILL else "owner")
    assert is_gone(int((tmp_path / "pid").read_text()))
    assert guarded.family() == []


def test_the_death_of_the_owner_ends_everything(tmp_path: Path) -> None:
    owner = f"""
import sys, time
sys.path.insert(0, {os.getcwd()!r})
from fmukit.guard.guarded import Guarded
guarded = Guarded([sys.executable, "-c", {DAEMON + "daemon(); time.sleep(600)"!r}, sys.argv[1]])
time.sleep(600)
"""
    with subprocess.Popen([sys.executable, "-c", owner, str(tmp_path / "pid")]) as process:
        until(lambda: (tmp_path / "pid").exists() and (tmp_path / "pid").read_text())
        process.kill()
    until(lambda: is_gone(int((tmp_path / "pid").read_text())))


def test_too_many_processes_end_it() -> None:
    text = "import os, time\nfor _ in range(200):\n    if os.fork() == 0: time.sleep(600)\ntime.sleep(600)"
    with python(text, limits=Limits(processes=20)) as guarded:
        ending = finished(guarded)
    assert ending.reason == "processes"
    assert ending.words(guarded.limits) == "was ended because it started more than 20 processes"
    assert guarded.family() == []


def test_too_much_memory_ends_it() -> None:
    text = "import time\nheap = []\nwhile True:\n    heap.append(b'x' * (1 << 20))\n    time.sleep(0.001)"
    with python(text, limits=Limits(memory=200 * MIB)) as guarded:
        ending = finished(guarded)
    assert ending.reason == "memory"
    assert 200 * MIB < ending.peak < 800 * MIB
    assert ending.words(guarded.limits) == "was ended because it took more than 200 MiB of memory"


def test_what_processes_share_counts_once() -> None:
    text = "import os, time\nheap = b'x' * (100 << 20)\nfor _ in range(8):\n    if os.fork() == 0: break\ntime.sleep(1)"
    with python(text, limits=Limits(memory=400 * MIB)) as guarded:
        assert (finished(guarded).code, guarded.end().reason) == (0, "")
    assert guarded.end().peak > 400 * MIB


def test_the_bounds_of_the_system_hold(tmp_path: Path) -> None:
    text = "heap = bytearray(300 << 20)"
    with python(text, limits=Limits(address_space=200 * MIB)) as guarded:
        assert finished(guarded).code == 1
    text = "open('large', 'wb').write(bytes(20 << 20))"
    with python(text, limits=Limits(file=10 * MIB), cwd=tmp_path) as guarded:
        assert finished(guarded).code == 1
    assert (tmp_path / "large").stat().st_size == 10 * MIB


def test_a_stopwatch_tells_work_from_sleep(tmp_path: Path) -> None:
    text = "import sys, time\nwhile time.process_time() < 0.5: pass\nopen(sys.argv[1], 'w')\ntime.sleep(600)"
    with python(text, tmp_path / "asleep") as guarded:
        watch = Stopwatch(guarded)
        until(lambda: watch.look() and (tmp_path / "asleep").exists())
        worked = watch.look()
        while (slept := watch.look() - worked).wall < 0.5:
            time.sleep(0.05)
    assert worked.cpu > 0.4
    assert slept.cpu < 0.1
    assert slept.had <= slept.wall


def test_a_stopwatch_sees_a_busy_machine() -> None:
    """Two processes on one processor: each of them starves for about half of the time."""
    loop = "import os, time\nos.sched_setaffinity(0, {min(os.sched_getaffinity(0))})\nwhile True: pass"
    with python(loop), python(loop) as guarded:
        watch = Stopwatch(guarded)
        while watch.look().cpu < 1.0:
            time.sleep(0.05)
        time_ = watch.look()
    assert time_.starved > 0.3
    assert abs(time_.wall - time_.cpu - time_.starved) < 0.5 * time_.wall


def test_ps_tells_the_same_as_proc() -> None:
    if not processes.listed():
        pytest.skip("there is no ps")
    me = os.getpid()
    mine, told = processes.everything()[me], processes.listed()[me]
    assert (mine.parent, mine.alive) == (told.parent, told.alive)
    assert abs(mine.memory - told.memory) < 0.2 * mine.memory


@pytest.mark.skipif(fence.height() < 6, reason="needs Landlock with scopes")
@pytest.mark.parametrize("deed", ["open('/tmp/fenced-out', 'w')", "os.kill(os.getppid(), 9)", "os.kill(1, 0)"])
def test_nothing_outside_the_fence_is_touched(deed: str, tmp_path: Path) -> None:
    text = f"import os\nopen('inside', 'w').write('x')\nopen('/dev/null', 'w').write('x')\n{deed}"
    with python(text, cwd=tmp_path, writable=[tmp_path], stderr=subprocess.PIPE) as guarded:
        assert guarded.stderr and b"PermissionError" in guarded.stderr.read()
        assert (finished(guarded).code, guarded.end().reason) == (1, "")
    assert (tmp_path / "inside").read_text() == "x"
    assert not Path("/tmp/fenced-out").exists()
