"""The rules as a whole: each has an id of its own, which it keeps, and stands in the documents."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from fmukit.conformance.report import rule_table
from fmukit.conformance.rule import Rules, in_order
from fmukit.conformance.rulebook import ALL, READING, RUNNING

RULES = Path(__file__).parents[2] / "docs" / "conformance-rules.md"
LAST = {"A": 17, "X": 49, "L": 16, "B": 21, "I": 4}


def _nothing_seen(_subject: object) -> Iterator[str]:
    yield from ()


def _table(*ids: str) -> Rules[object]:
    rules: Rules[object] = Rules()
    for id_ in ids:
        rules.add(id_, "a title", "2.2", "a remedy")(_nothing_seen)
    return rules


def test_ids_have_no_gaps_and_stand_in_order() -> None:
    assert [rule.id for rule in ALL] == [f"{letter}{k}" for letter, last in LAST.items() for k in range(1, last + 1)]
    assert {rule.id[0] for rule in READING} == {"A", "X"}
    assert {rule.id[0] for rule in RUNNING} == {"L", "B", "I"}


def test_the_documents_list_the_rules_as_they_are() -> None:
    assert rule_table(ALL) in RULES.read_text("utf-8"), (
        "put the output of `python -m fmukit.conformance` into docs/conformance-rules.md"
    )


def test_the_order_is_that_of_the_ids_and_not_of_the_tables() -> None:
    assert [rule.id for rule in in_order(_table("B2", "A11"), _table("B10", "A2"))] == ["A2", "A11", "B2", "B10"]


@pytest.mark.parametrize("tables", [[_table("A1", "A2", "A1")], [_table("A1"), _table("A2", "A1")]])
def test_an_id_given_twice_is_refused(tables: list[Rules[object]]) -> None:
    with pytest.raises(ValueError, match="there is more than one rule A1"):
        in_order(*tables)
