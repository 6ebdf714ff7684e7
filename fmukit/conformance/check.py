"""Check one FMU: apply the rules of the groups asked for, reading first, running only what is safe to run."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path

from fmukit.conformance.archive_rules import ARCHIVE
from fmukit.conformance.package import Package
from fmukit.conformance.rule import GROUPS, Finding, look
from fmukit.conformance.xml_rules.group import XML

ALL = "".join(GROUPS)
READING = (*ARCHIVE.rules, *XML.rules)


def check(path: Path | str, groups: str = ALL) -> list[Finding]:
    """One finding per rule of `groups` (letters of GROUPS); raises FileNotFoundError if there is no such file."""
    package = Package.read(path)
    findings = [look(rule, package) for rule in READING if rule.number[0] in groups]
    if set(groups) <= {"A", "X"}:
        return findings
    return findings + [finding for finding in _run(package) if finding.rule.number[0] in groups]


def _run(package: Package) -> list[Finding]:
    if find_spec("fmukit.conformance.running") is None:
        return []
    running = import_module("fmukit.conformance.running")  # lazy: FMPy, processes
    return list(running.run_groups(package))


def holds(findings: Sequence[Finding]) -> bool:
    """Whether no rule failed."""
    return all(finding.status != "fail" for finding in findings)
