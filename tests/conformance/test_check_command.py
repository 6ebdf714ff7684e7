"""The command `fmus check`: what it prints, its exit status, and one sentence for each mistake."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from broken import BROKEN
from lxml import etree
from program import fmus

from fmukit.conformance.rulebook import READING


@pytest.fixture
def bad(good: Path, tmp_path: Path) -> Path:
    *_, nominal = (broken for broken in BROKEN if broken.rule == "X36")
    return nominal.make(good, tmp_path / "bad.fmu")


def test_a_good_fmu_is_two_lines(good: Path) -> None:
    done = fmus("check", good, "--groups", "AX")
    assert (done.status, len(done.out.splitlines())) == (0, 2)
    assert f"{len(READING) - 1} rules hold, 1 do not apply" in done.out


def test_all_rules_can_be_listed(good: Path) -> None:
    done = fmus("check", good, "--groups", "AX", "--all")
    assert done.status == 0
    lines = [line for line in done.out.splitlines() if line[:1] in "AX" and not line.startswith("X39 skipped")]
    assert [line.split()[0] for line in lines] == [rule.id for rule in READING]
    assert f"{len(READING) - 1} rules hold, 1 do not apply" in done.out


def test_a_failing_rule_shows_the_value_and_the_remedy(bad: Path) -> None:
    done = fmus("check", bad, "--groups", "AX")
    assert done.status == 1
    assert "has the nominal value -5.0" in done.out
    assert "> Write the usual size of the variable" in done.out
    assert "1 violated (X36)" in done.out
    assert done.out.splitlines()[1].startswith("X36 "), "what does not hold comes first"


def test_json_holds_the_same_for_all_files(good: Path, bad: Path) -> None:
    done = fmus("check", good, bad, "--json", "--groups", "AX")
    records = json.loads(done.out)
    assert done.status == 1
    assert len(records) == 2 * len(READING)
    assert {(record["rule"], record["severity"]) for record in records} >= {
        ("X36", "violation"),
        ("A11", "advice"),
        ("A4", "violation"),
    }
    (failed,) = (record for record in records if record["status"] == "fail")
    assert (failed["file"], failed["rule"], failed["section"]) == (str(bad), "X36", "2.2.7")


def test_advice_is_told_and_fails_only_when_strict(good: Path, tmp_path: Path) -> None:
    (litter,) = (broken for broken in BROKEN if broken.rule == "A11")
    file = litter.make(good, tmp_path / "litter.fmu")
    done = fmus("check", file, "--groups", "A")
    assert done.status == 0
    assert "1 advised (A11)" in done.out
    assert fmus("check", file, "--groups", "A", "--strict").status == 1


def test_junit_holds_the_same(good: Path, bad: Path, tmp_path: Path) -> None:
    report = tmp_path / "report.xml"
    assert fmus("check", good, bad, "--groups", "AX", "--junit", report).status == 1
    root = etree.parse(report).getroot()
    assert (root.get("tests"), root.get("failures"), root.get("skipped")) == (str(2 * len(READING)), "1", "2")
    (failure,) = root.iter("failure")
    assert failure.getparent().get("name").startswith("X36 ")
    assert "has the nominal value -5.0" in failure.text
    done = fmus("check", good, "--groups", "A", "--junit", good)
    assert (done.status, done.err.count("\n")) == (2, 1)
    assert "would overwrite the FMU" in done.err and good.read_bytes().startswith(b"PK")
    odd = tmp_path / "a\x01b.fmu"
    odd.write_bytes(good.read_bytes())
    assert fmus("check", odd, "--groups", "A", "--junit", report).status == 0
    assert etree.parse(report).find("testsuite").get("name").endswith("a\\x01b.fmu")
    done = fmus("check", good, "--groups", "A", "--junit", tmp_path)
    assert (done.status, done.err.count("\n")) == (2, 1)
    assert "give --junit another file" in done.err


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["nowhere.fmu"], "nowhere.fmu does not exist"),
        (["."], ". is a folder"),
        ([__file__, "--groups", "Q"], "there is no group 'Q'"),
        ([], "Missing argument 'FILE...'"),
    ],
)
def test_unusable_arguments(arguments: list[str], sentence: str) -> None:
    done = fmus("check", *arguments)
    assert (done.status, done.out, done.err.count("\n")) == (2, "", 1)
    assert sentence in done.err
