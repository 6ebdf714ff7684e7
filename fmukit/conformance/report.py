"""The outcome of a check for people (a table) and for programs (JSON)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from rich.console import Group
from rich.table import Table
from rich.text import Text

from fmukit.conformance.rule import Finding, Rule

_STYLE = {"pass": "green", "fail": "bold red", "skip": "dim"}


def table(path: Path, findings: Sequence[Finding]) -> Group:
    """One line per rule; below a failing one what was seen (-) and the remedy (>). Reasons of skips come last."""
    grid = Table(box=None, pad_edge=False)
    for heading in ("rule", "what must hold", "section", "status"):
        grid.add_column(heading, no_wrap=heading in ("rule", "status"))
    for finding in findings:
        rule, style = finding.rule, _STYLE[finding.status]
        grid.add_row(rule.id, _story(finding), Text(rule.section), Text(finding.status, style))
    reasons = [Text(f"{ids} skipped: {reason}", "dim") for reason, ids in _skipped(findings).items()]
    return Group(grid, *reasons, Text(f"{path}: {summary(findings)}", "bold"))


def summary(findings: Sequence[Finding]) -> str:
    """How many rules hold, fail and do not apply, in words."""
    count = Counter(finding.status for finding in findings)
    failed = [finding.rule.id for finding in findings if finding.status == "fail"]
    words = [f"{count['pass']} rules hold"]
    words += [f"{count['skip']} do not apply"] if count["skip"] else []
    words += [f"{count['fail']} broken ({', '.join(failed)})"] if failed else []
    return ", ".join(words)


def sentences(path: Path, findings: Iterable[Finding]) -> str:
    """The failures as plain text, for an assertion; "" if there are none."""
    lines = []
    for finding in findings:
        if finding.status == "fail":
            lines += [f"{path}: {finding.rule.id} {finding.rule.title} (section {finding.rule.section})"]
            lines += [f"  - {_printable(seen)}" for seen in finding.seen] + [f"  > {finding.rule.remedy}"]
    return "\n".join(lines)


def rule_table(rules: Iterable[Rule[Any]]) -> str:
    """Id, title and section of the rules as a Markdown table."""
    lines = [f"| {rule.id} | {rule.title} | {rule.section} |" for rule in rules]
    return "\n".join(["| rule | what must hold | section |", "|---|---|---|", *lines])


def records(path: Path, findings: Iterable[Finding]) -> list[dict[str, object]]:
    """The same as the table, as data."""
    return [
        {
            "file": str(path),
            "rule": finding.rule.id,
            "group": finding.rule.group,
            "title": finding.rule.title,
            "section": finding.rule.section,
            "status": finding.status,
            "seen": list(finding.seen),
            "remedy": finding.rule.remedy if finding.status == "fail" else "",
        }
        for finding in findings
    ]


def _story(finding: Finding) -> Text:
    text = Text(finding.rule.title)
    if finding.status == "fail":
        for seen in finding.seen:
            text.append(f"\n- {_printable(seen)}", _STYLE["fail"])
        text.append(f"\n> {finding.rule.remedy}")
    return text


def _skipped(findings: Iterable[Finding]) -> dict[str, str]:
    """Reason -> ids of the rules."""
    ids: dict[str, list[str]] = {}
    for finding in findings:
        if finding.status == "skip":
            ids.setdefault(_printable(" ".join(finding.seen)), []).append(finding.rule.id)
    return {reason: ", ".join(rules) for reason, rules in ids.items()}


def _printable(text: str) -> str:
    """Names come from strangers and must not steer the terminal."""
    return "".join(c if c.isprintable() else " " if c.isspace() else f"\\x{ord(c):02x}" for c in text)
