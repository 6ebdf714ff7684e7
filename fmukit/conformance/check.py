"""Check one FMU: read it, then run what can be run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fmukit.conformance.package import Package
from fmukit.conformance.rule import GROUPS, Finding, look
from fmukit.conformance.rulebook import READING
from fmukit.conformance.running import of_groups, run_groups, skipped
from fmukit.conformance.vital import unfit

ALL = "".join(GROUPS)
READ_ONLY = frozenset(rule.id[0] for rule in READING)


def check(path: Path | str, groups: str = ALL, others: Sequence[Path | str] = ()) -> list[Finding]:
    """One finding per rule of `groups` (letters of GROUPS); raises FileNotFoundError if there is no such file.

    The groups A and X only read. L, B and I run the FMU in processes of their own, with the rights of the caller, and
    `others` beside it. An FMU that breaks a vital rule of A is not run: without its script a Python FMU takes the
    process down.
    """
    package = Package.read(path)
    findings = [look(rule, package) for rule in READING if rule.id[0] in groups]
    if READ_ONLY.issuperset(groups):
        return findings
    return findings + _run(package, groups, others)


def _run(package: Package, groups: str, others: Sequence[Path | str]) -> list[Finding]:
    broken = unfit(package)
    if broken:
        return skipped(of_groups(groups), f"not run, because rule {broken[0].id} does not hold")
    return run_groups(package, others, groups=groups)


def holds(findings: Sequence[Finding], *, strict: bool = False) -> bool:
    """Whether the FMU violates no rule of the standard; `strict`: nor any that is advice."""
    return not any(finding.fails(strict=strict) for finding in findings)


def decided(findings: Sequence[Finding]) -> bool:
    """Whether it is known of every rule if it holds."""
    return all(finding.status != "undecided" for finding in findings)
