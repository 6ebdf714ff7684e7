"""Check one FMU: read it, then run what can be run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fmukit.conformance.archive_rules import ARCHIVE
from fmukit.conformance.package import Package
from fmukit.conformance.rule import GROUPS, Finding, Rule, look
from fmukit.conformance.xml_rules.group import XML

ALL = "".join(GROUPS)
READING = (*ARCHIVE.rules, *XML.rules)
VITAL = ("A1", "A14")
"""An FMU that breaks one of these is not run: a Python FMU without its script takes the process down."""


def check(path: Path | str, groups: str = ALL, others: Sequence[Path | str] = ()) -> list[Finding]:
    """One finding per rule of `groups` (letters of GROUPS); raises FileNotFoundError if there is no such file.

    The groups A and X only read. L, B and I run the FMU in processes of their own, with the rights of the caller, and
    `others` beside it.
    """
    package = Package.read(path)
    findings = [look(rule, package) for rule in READING if rule.number[0] in groups]
    if set(groups) <= {"A", "X"}:
        return findings
    return findings + [finding for finding in _run(package, others) if finding.rule.number[0] in groups]


def _run(package: Package, others: Sequence[Path | str]) -> list[Finding]:
    from fmukit.conformance.groups import RULES  # noqa: PLC0415  (lazy: reading needs no FMPy)
    from fmukit.conformance.running import run_groups  # noqa: PLC0415

    broken = [rule.number for rule in READING if rule.number in VITAL and look(rule, package).status == "fail"]
    if broken:
        reason = f"not run, because rule {broken[0]} does not hold"
        return [Finding(rule, "skip", (reason,)) for rule in RULES]
    return run_groups(package, others)


def every_rule() -> list[Rule[Any]]:
    """The rules of all groups, in the order they are applied."""
    from fmukit.conformance.groups import RULES  # noqa: PLC0415  (lazy: FMPy)

    return [*READING, *RULES]


def holds(findings: Sequence[Finding]) -> bool:
    """Whether no rule failed."""
    return all(finding.status != "fail" for finding in findings)
