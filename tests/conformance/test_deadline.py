"""A hang is told from a busy machine, and what cannot be decided is called that, with an exit status of its own."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from lxml import etree
from program import fmus

from fmukit.conformance import command
from fmukit.conformance.check import decided, holds
from fmukit.conformance.deadline import Deadline
from fmukit.conformance.rule import Finding
from fmukit.conformance.rulebook import ALL
from fmukit.guard.stopwatch import Time

DEADLINE = Deadline(call=10.0, rule=100.0, busy=4.0)
SHORT = Time(1.0, 1.0, 0.0)


@pytest.mark.parametrize(
    ("past", "words"),
    [
        (Time(10.1, 0.1, 0.0), "did not return within 10 s, in which it used the processor for 0.1 s: it sleeps"),
        (Time(10.1, 10.0, 0.0), "did not return within 10 s, in which it used the processor for 10.0 s"),
        (Time(30.0, 10.0, 19.9), "did not return within 10 s, in which it used the processor for 10.0 s"),
    ],
)
def test_a_call_that_had_its_time_fails(past: Time, words: str) -> None:
    status, sentence = DEADLINE.over("fmi2DoStep", past, past) or ("", "")
    assert status == "fail"
    assert words in sentence


def test_nothing_is_said_of_a_processor_that_nobody_counts() -> None:
    past = Time(10.1, math.nan, 0.0)
    assert DEADLINE.over("fmi2DoStep", past, past) == ("fail", "fmi2DoStep did not return within 10 s")


def test_a_starved_call_is_undecided() -> None:
    past = Time(40.1, 2.0, 38.0)
    status, sentence = DEADLINE.over("fmi2DoStep", past, past) or ("", "")
    assert status == "undecided"
    assert "too busy: in 40 s the FMU had the processor for 2.0 s and had to wait for it for 38 s" in sentence


def test_a_rule_of_many_short_calls_is_undecided_in_the_end() -> None:
    assert DEADLINE.over("fmi2DoStep", SHORT, Time(99.0, 99.0, 0.0)) is None
    status, sentence = DEADLINE.over("", SHORT, Time(101.0, 101.0, 0.0)) or ("", "")
    assert (status, "the calls of this FMU take long" in sentence) == ("undecided", True)


@pytest.mark.parametrize("past", [Time(9.9, 9.9, 0.0), Time(30.0, 3.0, 25.0)])
def test_there_is_time_left(past: Time) -> None:
    assert DEADLINE.over("fmi2DoStep", past, past) is None


def test_what_is_undecided_neither_holds_nor_fails(good: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found = [Finding(rule, "pass") for rule in ALL[:-1]] + [Finding(ALL[-1], "undecided", ("it was too busy",))]
    assert holds(found) and not decided(found)
    monkeypatch.setattr(command, "check", lambda *_: found)
    report = tmp_path / "report.xml"
    done = fmus("check", good, "--junit", report)
    assert done.status == 3
    assert f"1 undecided ({ALL[-1].id})" in done.out and "- it was too busy" in done.out
    assert ALL[-1].remedy[:30] not in done.out
    (error,) = etree.parse(report).getroot().iter("error")
    assert error.get("message") == "it was too busy"
    records = json.loads(fmus("check", good, "--json").out)
    assert [record["status"] for record in records][-1] == "undecided"
