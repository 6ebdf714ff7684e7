"""FMUs that attack: the check ends with findings, none of their processes stays, nothing outside is touched."""

from __future__ import annotations

import re
import secrets
import shutil
import sys
from pathlib import Path

import pytest
from small_fmu import SOURCES, compiled

from fmukit.conformance import attendant
from fmukit.conformance.check import check
from fmukit.conformance.deadline import Deadline
from fmukit.conformance.rule import Finding
from fmukit.conformance.rulebook import ALL, RUNNING
from fmukit.conformance.running import run_groups
from fmukit.guard.keeper import fence, processes
from fmukit.guard.keeper.limits import MIB, Limits

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux") or shutil.which("cc") is None, reason="needs Linux and a C compiler"
)
HOSTILE = sorted((SOURCES.parent / "hostile").glob("*.c"))
FENCED = {"kills_parent", "stops_parent", "kills_ancestors", "writes_outside", "goes_away", "deletes_outside"}
"""What needs the fence: without it these do harm, if only to themselves and to files of the same user."""
QUICK = [
    "aborts",
    "alarm",
    "another_program",
    "exits",
    "exits_at_once",
    "float_trap",
    "fork_bomb",
    "forks",
    "forges_and_exits",
    "frees_foreign",
    "is_traced",
    "kills_group",
    "kills_itself",
    "kills_parent_and_stays",
    "limits_itself",
    "loops_when_made",
    "null_pointer",
    "overflows_stack",
    "reserves_addresses",
    "sleeps",
    "stays_unmarked",
    "stops_itself",
    "takes_memory_together",
    "throws",
    "truncates_itself",
    "waits_for_child",
    "writes_outside",
    "kills_ancestors",
]
"""What ends within the first rules, and so soon; the others are tried at night."""
DEADLINE = Deadline(call=4.0, rule=40.0, busy=15.0, check=600.0)
_SAID = re.compile(r"/\* said: (.*) \*/")


def said(source: Path) -> str:
    """What must be said of this FMU, "" if there is nothing in particular."""
    found = _SAID.search(source.read_text("utf-8"))
    return found[1] if found else ""


@pytest.fixture
def outside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that the FMU knows of and has no business in."""
    folder = tmp_path / "outside"
    folder.mkdir()
    (folder / "precious").write_text("precious", "utf-8")
    monkeypatch.setenv("HOSTILE_OUTSIDE", str(folder))
    return folder


@pytest.fixture
def mark(monkeypatch: pytest.MonkeyPatch) -> str:
    """NAME=VALUE in the environment of all processes started by a test."""
    value = secrets.token_hex(8)
    monkeypatch.setenv("HOSTILE_MARK", value)
    return f"HOSTILE_MARK={value}"


def sentences(findings: list[Finding]) -> str:
    return "\n".join(f"{f.rule.id} {f.status}: {sentence}" for f in findings for sentence in f.seen)


def asleep() -> int:
    """How many `sleep 600` there are, with an environment or without."""
    return sum(_command(process.pid) == ["sleep", "600"] for process in processes.everything().values())


def _command(pid: int) -> list[str]:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().decode("utf-8", "replace").split("\0")[:-1]
    except OSError:
        return []


def _when(source: Path) -> object:
    marks = () if source.stem in QUICK else (pytest.mark.nightly,)
    return pytest.param(source, id=source.stem, marks=marks)


@pytest.mark.parametrize("source", [_when(source) for source in HOSTILE])
def test_the_check_survives(
    source: Path, outside: Path, mark: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if source.stem in FENCED and fence.height() < 6:
        pytest.skip("needs Landlock with scopes")
    monkeypatch.setattr(attendant, "limits", lambda: Limits(memory=1024 * MIB))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    file = compiled(source, tmp_path)
    before, sleeping = set(tmp_path.rglob("*")), asleep()
    findings = run_groups(file, deadline=DEADLINE)
    assert [finding.rule for finding in findings] == list(RUNNING)
    assert {finding.status for finding in findings} <= {"pass", "fail", "skip"}, sentences(findings)
    assert said(source) in sentences(findings), sentences(findings)
    assert "Traceback" not in sentences(findings)
    assert processes.bearing(mark) == []
    assert asleep() == sleeping
    assert set(tmp_path.rglob("*")) == before
    assert (outside / "precious").read_text("utf-8") == "precious"


def test_there_are_enough_of_them() -> None:
    assert len(HOSTILE) >= 80
    assert set(QUICK) <= {source.stem for source in HOSTILE}
    assert len(QUICK) >= 25


def test_forged_answers_pass_nothing(tmp_path: Path) -> None:
    """The FMU that dies of its first step says on every descriptor that all is well."""
    findings = check(compiled(SOURCES.parent / "hostile" / "forges_and_exits.c", tmp_path))
    assert [finding.rule for finding in findings] == list(ALL)
    states = {finding.rule.id: finding.status for finding in findings if finding.rule in RUNNING}
    assert (states.pop("L1"), states.pop("L2"), states.pop("I4")) == ("pass", "fail", "fail")
    assert set(states.values()) == {"skip"}
