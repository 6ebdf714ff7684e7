"""The command `fmus check`: what it prints, its exit status, and one sentence for each mistake."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from broken import BROKEN
from program import fmus

from fmukit.conformance.rulebook import READING


@pytest.fixture
def bad(good: Path, tmp_path: Path) -> Path:
    (nominal,) = (broken for broken in BROKEN if broken.rule == "X36")
    return nominal.make(good, tmp_path / "bad.fmu")


def test_a_good_fmu_exits_with_0_and_one_line_per_rule(good: Path) -> None:
    done = fmus("check", good, "--groups", "AX")
    assert done.status == 0
    lines = [line for line in done.out.splitlines() if line[:1] in "AX" and not line.startswith("X39 skipped")]
    assert [line.split()[0] for line in lines] == [rule.id for rule in READING]
    assert f"{len(READING) - 1} rules hold, 1 do not apply" in done.out


def test_a_failing_rule_shows_the_value_and_the_remedy(bad: Path) -> None:
    done = fmus("check", bad, "--groups", "AX")
    assert done.status == 1
    assert "has the nominal value -5.0" in done.out
    assert "> Write the usual size of the variable" in done.out
    assert "1 broken (X36)" in done.out


def test_json_holds_the_same_for_all_files(good: Path, bad: Path) -> None:
    done = fmus("check", good, bad, "--json", "--groups", "AX")
    records = json.loads(done.out)
    assert done.status == 1
    assert len(records) == 2 * len(READING)
    (failed,) = (record for record in records if record["status"] == "fail")
    assert (failed["file"], failed["rule"], failed["section"]) == (str(bad), "X36", "2.2.7")


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
