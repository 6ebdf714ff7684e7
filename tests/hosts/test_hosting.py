"""`fmus host` and `fmus doctor`: what a foreign host gets, and what a user is told."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
from pathlib import Path

import pytest

from fmukit.hosting import environment as hosting
from fmukit.hosting.requirements import requirements

ROOT = Path(__file__).parents[2]


def fmus(*arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **variables}
    command = [sys.executable, "-m", "fmus", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment)


def test_the_library_is_that_of_this_interpreter():
    library = hosting.libpython()
    assert library is not None
    version = ctypes.CDLL(str(library)).Py_GetVersion
    version.restype = ctypes.c_char_p
    assert version().decode() == sys.version


def test_variables_are_put_before_what_is_there():
    made = hosting.environment({"PATH": "/usr/bin", "LD_PRELOAD": "libx.so", "OTHER": "kept"})
    assert made["PATH"] == f"{Path(sys.executable).parent}:/usr/bin"
    assert made["LD_PRELOAD"] == f"{hosting.libpython()}:libx.so"
    assert made["LD_LIBRARY_PATH"] == f"{sys.prefix}/lib"
    assert made["OTHER"] == "kept"


def test_a_host_gets_its_arguments_and_gives_its_status():
    program = "import os, sys; print(sys.argv[1:], 'libpython' in os.environ['LD_PRELOAD']); sys.exit(7)"
    for dashes in ((), ("--",)):
        done = fmus("host", *dashes, "python3", "-c", program, "--json", "-d", "a b")
        assert (done.returncode, done.stdout) == (7, "['--json', '-d', 'a b'] True\n"), done.stderr


def test_a_host_killed_by_a_signal_is_seen_as_such():
    assert fmus("host", "--", "sh", "-c", "kill -SEGV $$").returncode == -11


@pytest.mark.parametrize(
    ("arguments", "words"),
    [(("--", "no-such-tool"), "there is no program 'no-such-tool' on PATH"), ((), "Missing")],
)
def test_mistakes_are_one_sentence(arguments, words):
    done = fmus("host", *arguments)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert words in done.stderr


def test_without_a_library_the_user_is_warned(monkeypatch):
    monkeypatch.setattr(hosting, "library_places", lambda: [Path("/nowhere/libpython.so")])
    assert hosting.libpython() is None
    assert "LD_PRELOAD" not in hosting.environment({"PATH": "/usr/bin"})
    library = next(requirement for requirement in requirements() if requirement.thing == "libpython")
    assert not library.there
    assert "apt install libpython" in library.remedy


def test_the_doctor_is_content_here():
    done = fmus("doctor")
    assert (done.returncode, done.stderr) == (0, "")
    words = [line.split()[:2] for line in done.stdout.splitlines()]
    assert words == [["ok", "platform"], ["ok", "compiler"], ["ok", "libpython"], ["ok", "cache"], ["ok", "temporary"]]


@pytest.mark.parametrize(
    ("variables", "remedy"),
    [
        ({"CC": "/no/compiler"}, "compiler: install gcc or clang"),
        ({"CC": "false"}, "compiler: install gcc or clang"),
        ({"XDG_CACHE_HOME": "/proc/nowhere"}, "cache folder: make it writable"),
    ],
)
def test_the_doctor_names_what_is_missing_and_the_remedy(variables, remedy):
    done = fmus("doctor", **variables)
    assert (done.returncode, done.stderr) == (1, "")
    assert sum(line.startswith("missing") for line in done.stdout.splitlines()) == 1
    assert done.stdout.splitlines()[-1].startswith(remedy)


def test_the_doctor_warns_of_a_folder_other_hosts_crash_in(tmp_path):
    odd = tmp_path / "größe"
    odd.mkdir()
    done = fmus("doctor", TMPDIR=str(odd))
    assert (done.returncode, done.stdout.splitlines()[-1][:24]) == (1, "temporary: set TMPDIR (W")


def test_other_machines_are_named(monkeypatch):
    monkeypatch.setattr("platform.machine", lambda: "aarch64")
    first = next(requirements())
    assert (first.thing, first.there) == ("platform", False)
    assert "aarch64" in first.seen
