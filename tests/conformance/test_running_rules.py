"""Each rule of the running FMU holds on sound FMUs and is the only one that fails on an FMU made to break it."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from time import monotonic

import pytest
from small_fmu import SOURCES, breaks, changed, compiled

from fmukit.conformance import attendant
from fmukit.conformance.deadline import Deadline
from fmukit.conformance.rule import Finding
from fmukit.conformance.rulebook import RUNNING
from fmukit.conformance.running import run_groups
from fmukit.guard.guarded import Guarded
from fmukit.guard.stopwatch import Time

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux") or shutil.which("cc") is None, reason="needs Linux and a C compiler"
)
FILES = sorted(SOURCES.glob("*.c"))
CHECKS = {rule.check.__name__ for rule in RUNNING}


SENTENCES = {
    "crash_in_early_free": "the process was killed by signal 6 (Aborted)",
    "endless_step": "fmi2DoStep did not return within 4 s, in which it used the processor for 0",
    "error_in_step": "fmi2DoStep at 0.03 s answers error (a step must go forward)",
    "not_a_number": "y is nan at 0.21 s",
    "other_start_value": "gain is 3.0, its declared start value is 2.0",
    "takes_nan": "u = nan is accepted: status ok and no message",
    "leaks_handle": "60 lives of 10 steps left 60 file handles open",
}


def failing(findings: list[Finding]) -> dict[str, str]:
    return {f.rule.check.__name__: " ".join(f.seen) for f in findings if f.status == "fail"}


@pytest.mark.parametrize("source", FILES, ids=lambda source: source.stem)
def test_exactly_the_intended_rule_fails(source: Path, tmp_path: Path) -> None:
    findings = run_groups(
        compiled(source, tmp_path), deadline=Deadline(call=4.0 if source.stem == "endless_step" else 30.0)
    )
    assert [finding.rule for finding in findings] == list(RUNNING)
    failed = failing(findings)
    assert failed.keys() == ({breaks(source)} - {"nothing"})
    assert SENTENCES.get(source.stem, "") in " ".join(failed.values())


_LEAVE = "def _leave_path(resources: str) -> None:\n"
PYTHON = {
    "no_host_packages": ("/__init__.py", lambda text: f"{text}\nimport numpy\n", {}, "No module named|not run"),
    "module_path": ("/slave.py", lambda text: text.replace(_LEAVE, f"{_LEAVE}    return\n"), {}, "60"),
    "same_names": (
        "/__init__.py",
        lambda text: f"{text}\nimport helper\nGAIN = helper.GAIN\n",
        {"helper": "GAIN = 2.0\n"},
        "modules named helper",
    ),
}


@pytest.mark.parametrize("rule", PYTHON)
def test_exactly_the_intended_rule_fails_on_python_fmus(rule: str, good: Path, tmp_path: Path) -> None:
    member, change, more, words = PYTHON[rule]
    package = "fmu_" if member == "/__init__.py" else "runtime"
    findings = run_groups(changed(good, tmp_path / "broken.fmu", f"{package}[^/]*{member}", change, **more))
    assert failing(findings).keys() == {rule}
    assert any(word in failing(findings)[rule] for word in words.split("|"))


def test_every_rule_has_an_fmu_that_breaks_it() -> None:
    assert {breaks(source) for source in FILES} | PYTHON.keys() == CHECKS | {"nothing"}


def test_rules_after_a_crash_are_still_looked_at(tmp_path: Path) -> None:
    findings = run_groups(compiled(SOURCES / "crash_in_early_free.c", tmp_path))
    place = [finding.status for finding in findings].index("fail")
    assert {finding.status for finding in findings[place + 1 :]} == {"pass", "skip"}


class Starved:
    """The stopwatch of a machine on which the FMU gets a tenth of the time."""

    def __init__(self, _guarded: Guarded) -> None:
        self._began = monotonic()

    def look(self) -> Time:
        wall = monotonic() - self._began
        return Time(wall, 0.1 * wall, 0.9 * wall)


def test_a_busy_machine_is_not_blamed_on_the_fmu(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What would be a hang with a processor of its own is undecided, and so is what stands on it."""
    monkeypatch.setattr(attendant, "Stopwatch", Starved)
    source, deadline = SOURCES / "endless_step.c", Deadline(call=2.0, busy=3.0)
    one, two, *rest = run_groups(compiled(source, tmp_path), deadline=deadline, groups="L")
    assert (one.status, two.status) == ("pass", "undecided")
    assert "the machine was too busy: in 6 s the FMU had the processor for 0.6 s" in two.seen[0]
    assert {finding.seen for finding in rest} == {("not looked at, because rule L2 is undecided",)}


def test_without_foundation_the_rest_is_skipped_and_says_why(tmp_path: Path) -> None:
    first, *rest = run_groups(compiled(SOURCES / "crash_in_free.c", tmp_path))
    assert first.status == "fail"
    assert {finding.seen for finding in rest} == {("not looked at, because rule L1 does not hold",)}


def test_two_fmus_that_share_module_names_disturb_each_other(good: Path, tmp_path: Path) -> None:
    """The second one runs the code of the first."""
    files = []
    for number, gain in enumerate((2.0, 3.0)):
        member, change, _, _ = PYTHON["same_names"]
        file = tmp_path / f"version{number}.fmu"
        scale = "from .runtime.values import Values\nValues.plain = Values.reals\n"
        scale += "Values.reals = lambda s, v: [x * GAIN for x in s.plain(v)] if v[0] > 20 else s.plain(v)\n"
        files.append(
            changed(
                good,
                file,
                f"fmu_[^/]*{member}",
                lambda text, scale=scale, change=change: change(text) + scale,
                helper=f"GAIN = {gain}\n",
            )
        )
    found = {f.rule.check.__name__: f for f in run_groups(files[0], others=files[1:])}
    assert found["any_order"].status == "fail"
    assert "differs" in " ".join(found["any_order"].seen)


def test_what_cannot_be_run_is_skipped_with_the_reason(tmp_path: Path) -> None:
    file = tmp_path / "empty.fmu"
    file.write_bytes(b"not a zip")
    assert {finding.status for finding in run_groups(file)} == {"skip"}
    assert "cannot be read" in run_groups(file)[0].seen[0]
