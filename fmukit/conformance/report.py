"""The outcome of a check for people (a table) and for programs (JSON; `junit` has the other form)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from rich.console import Group
from rich.table import Table
from rich.text import Text

from fmukit.conformance.rule import Finding, Rule, Severity

_SAID: dict[Severity, str] = {"violation": "violated", "advice": "advised"}
_STYLE = {"pass": "green", "violation": "bold red", "advice": "yellow", "undecided": "magenta", "skip": "dim"}


def table(path: Path, findings: Sequence[Finding], *, everything: bool = False) -> Group:
    """What does not hold, violations first: what was seen (-) and the remedy (>); then what is undecided and why.

    The rest only if `everything`.
    """
    broken = [f for kind in _SAID for f in findings if f.is_broken(kind)]
    broken += [f for f in findings if f.status == "undecided"]
    rest = [f for f in findings if f not in broken]
    shown = [*broken, *rest] if everything else broken
    grid = Table(box=None, pad_edge=False)
    for heading in ("rule", "what must hold", "section", "status"):
        grid.add_column(heading, no_wrap=heading in ("rule", "status"))
    for finding in shown:
        rule, word = finding.rule, _word(finding)
        grid.add_row(rule.id, _story(finding), Text(_section(rule)), Text(word, _STYLE[word]))
    reasons = [Text(f"{ids} skipped: {reason}", "dim") for reason, ids in _skipped(findings).items()]
    return Group(*([grid] if shown else []), *reasons, Text(f"{printable(str(path))}: {summary(findings)}", "bold"))


def summary(findings: Sequence[Finding]) -> str:
    """How many rules hold and do not apply, which are violated and which are advised, in words."""
    count = Counter(map(_word, findings))
    words = [f"{count['pass']} rules hold"]
    words += [f"{count['skip']} do not apply"] if count["skip"] else []
    for severity, participle in _SAID.items():
        ids = [finding.rule.id for finding in findings if finding.is_broken(severity)]
        words += [f"{len(ids)} {participle} ({', '.join(ids)})"] if ids else []
    undecided = [finding.rule.id for finding in findings if finding.status == "undecided"]
    words += [f"{len(undecided)} undecided ({', '.join(undecided)})"] if undecided else []
    return ", ".join(words)


def sentences(path: Path, findings: Iterable[Finding], *, strict: bool) -> str:
    """The violations and what is undecided as plain text, for an assertion, `strict`: and the advice; or ""."""
    lines = []
    for finding in findings:
        if finding.fails(strict=strict) or finding.status == "undecided":
            lines += [
                f"{path}: {finding.rule.id} {finding.rule.title} (section {_section(finding.rule)})",
                *said(finding),
            ]
    return "\n".join(lines)


def said(finding: Finding) -> list[str]:
    """What was seen of a rule that does not hold, and the remedy, a line each; or why the rule is undecided."""
    remedy = [f"  > {finding.rule.remedy}"] if finding.status == "fail" else []
    return [*(f"  - {printable(seen)}" for seen in finding.seen), *remedy]


def rule_table(rules: Iterable[Rule[Any]]) -> str:
    """Id, title, section and severity of the rules as a Markdown table."""
    lines = [f"| {rule.id} | {rule.title} | {_section(rule)} | {rule.severity} |" for rule in rules]
    return "\n".join(["| rule | what must hold | section | otherwise |", "|---|---|---|---|", *lines])


def records(path: Path, findings: Iterable[Finding]) -> list[dict[str, object]]:
    """The same as the table, as data."""
    return [
        {
            "file": str(path),
            "rule": finding.rule.id,
            "group": finding.rule.group,
            "title": finding.rule.title,
            "section": finding.rule.section,
            "severity": finding.rule.severity,
            "status": finding.status,
            "seen": list(finding.seen),
            "remedy": finding.rule.remedy if finding.status == "fail" else "",
        }
        for finding in findings
    ]


def _word(finding: Finding) -> str:
    return finding.rule.severity if finding.status == "fail" else finding.status


def _section(rule: Rule[Any]) -> str:
    return f"{rule.section}, disputed" if rule.disputed else rule.section


def _story(finding: Finding) -> Text:
    text = Text(finding.rule.title)
    if finding.status in ("fail", "undecided"):
        for seen in finding.seen:
            text.append(f"\n- {printable(seen)}", _STYLE[_word(finding)])
    if finding.status == "fail":
        text.append(f"\n> {finding.rule.remedy}")
    return text


def _skipped(findings: Iterable[Finding]) -> dict[str, str]:
    """Reason -> ids of the rules."""
    ids: dict[str, list[str]] = {}
    for finding in findings:
        if finding.status == "skip":
            ids.setdefault(printable(" ".join(finding.seen)), []).append(finding.rule.id)
    return {reason: ", ".join(rules) for reason, rules in ids.items()}


def printable(text: str) -> str:
    """Names come from strangers and must not steer the terminal."""
    return "".join(c if c.isprintable() else " " if c.isspace() else f"\\x{ord(c):02x}" for c in text)
