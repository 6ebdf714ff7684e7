"""Groups A and X: every rule holds for our FMUs, and on each broken FMU exactly the rule that is meant fails."""

from __future__ import annotations

from pathlib import Path

import everything
import pytest
from broken import BROKEN, Broken

from fmukit.component import Component
from fmukit.conformance.check import check
from fmukit.conformance.pytest_helper import assert_conformant
from fmukit.conformance.rulebook import READING
from fmukit.packaging.cached import cached
from fmus import CATALOGUE


@pytest.mark.parametrize("component", CATALOGUE, ids=lambda component: component.interface.name)
def test_every_rule_holds_for_the_catalogue(component: Component) -> None:
    assert_conformant(cached(component), "AX", strict=True)


def test_every_rule_holds_for_everything_the_standard_allows(good: Path, tmp_path: Path) -> None:
    assert_conformant(everything.make(good, tmp_path / "rich.fmu"), "AX", strict=True)


def test_every_rule_holds_for_some_fmu(good: Path, tmp_path: Path) -> None:
    """Not merely skipped everywhere."""
    found = [*check(good, "AX"), *check(everything.make(good, tmp_path / "rich.fmu"), "AX")]
    assert {finding.rule.id for finding in found if finding.status == "pass"} == {rule.id for rule in READING}


def _made(broken: Broken, good: Path, folder: Path) -> Path:
    path = broken.make(good, folder / "broken.fmu")
    if broken.rule == "A1":
        path.write_bytes(path.read_bytes().replace(b"FLIPPED", b"FLOPPED", 1))
    return path


@pytest.mark.parametrize("broken", BROKEN, ids=[f"{broken.rule}-{i}" for i, broken in enumerate(BROKEN)])
def test_exactly_the_intended_rule_fails(broken: Broken, good: Path, tmp_path: Path) -> None:
    path = _made(broken, good, tmp_path)
    failed = {finding.rule.id: finding for finding in check(path, "AX") if finding.status == "fail"}
    assert failed.keys() == {broken.rule}, failed
    assert broken.says in " ".join(failed[broken.rule].seen)


@pytest.mark.parametrize("vital", [rule.id for rule in READING if rule.vital])
def test_what_breaks_a_vital_rule_is_not_run(vital: str, good: Path, tmp_path: Path) -> None:
    broken = next(broken for broken in BROKEN if broken.rule == vital)
    findings = check(_made(broken, good, tmp_path))
    assert [finding.rule.id for finding in findings if finding.status == "fail"] == [vital]
    assert {finding.status for finding in findings if finding.rule.id[0] in "LBI"} == {"skip"}


def test_every_rule_has_a_broken_fmu() -> None:
    assert {broken.rule for broken in BROKEN} == {rule.id for rule in READING}


def test_the_helper_says_what_is_wrong_and_what_to_do(good: Path, tmp_path: Path) -> None:
    *_, lacking = (broken for broken in BROKEN if broken.rule == "X36")
    path = lacking.make(good, tmp_path / "broken.fmu")
    with pytest.raises(AssertionError, match=r"X36 Nominal .*\(section 2.2.7\)\n  - variable .* -5.0\n  > Write"):
        assert_conformant(path, "AX", strict=True)
