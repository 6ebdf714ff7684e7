"""The command `fmus check`: what it prints, its exit status, and one sentence for each mistake."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from broken import BROKEN
from typer.testing import CliRunner

from fmukit.conformance.check import READING, every_rule
from fmukit.conformance.report import rule_table
from fmus import cli

RULES = Path(__file__).parents[2] / "docs" / "conformance-rules.md"


def _check(*arguments: str | Path) -> tuple[int, str]:
    done = CliRunner().invoke(cli.app, ["check", *map(str, arguments)], env={"COLUMNS": "200"})
    return done.exit_code, done.stdout


@pytest.fixture
def bad(good: Path, tmp_path: Path) -> Path:
    (nominal,) = (broken for broken in BROKEN if broken.rule == "X36")
    return nominal.make(good, tmp_path / "bad.fmu")


def test_a_good_fmu_exits_with_0_and_one_line_per_rule(good: Path) -> None:
    code, out = _check(good, "--groups", "AX")
    assert code == 0
    lines = [line.split()[0] for line in out.splitlines() if line[:1] in "AX" and not line.startswith("X39 skipped")]
    assert lines == [rule.number for rule in READING]
    assert f"{len(READING) - 1} rules hold, 1 do not apply" in out


def test_a_failing_rule_shows_the_value_and_the_remedy(bad: Path) -> None:
    code, out = _check(bad, "--groups", "AX")
    assert code == 1
    assert "has the nominal value -5.0" in out
    assert "> Write the usual size of the variable" in out
    assert "1 broken (X36)" in out


def test_json_holds_the_same_for_all_files(good: Path, bad: Path) -> None:
    code, out = _check(good, bad, "--json", "--groups", "AX")
    records = json.loads(out)
    assert code == 1
    assert len(records) == 2 * len(READING)
    (failed,) = (record for record in records if record["status"] == "fail")
    assert (failed["file"], failed["rule"], failed["section"]) == (str(bad), "X36", "2.2.7")


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["nowhere.fmu"], "nowhere.fmu does not exist"),
        (["."], ". is a folder"),
        ([__file__, "--groups", "Q"], "there is no group 'Q'"),
        ([], "Missing parameter: files"),
    ],
)
def test_unusable_arguments(
    arguments: list[str], sentence: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["fmus", "check", *arguments])
    with pytest.raises(SystemExit) as end:
        cli.main()
    out, err = capsys.readouterr()
    assert (end.value.code, out, err.count("\n")) == (2, "", 1)
    assert sentence in err


def test_the_documents_list_the_rules_as_they_are() -> None:
    assert rule_table(every_rule()) in RULES.read_text("utf-8"), (
        "put the output of `python -m fmukit.conformance` into docs/conformance-rules.md"
    )
