"""Whether an FMU may be loaded at all: what breaks a vital rule takes down the process that runs it."""

from __future__ import annotations

from fmukit.conformance import archive_rules, binary_rules
from fmukit.conformance.package import Package
from fmukit.conformance.rule import Rule, in_order, look

VITAL: tuple[Rule[Package], ...] = tuple(
    rule for rule in in_order(archive_rules.FILE, archive_rules.ENTRIES, binary_rules.RULES) if rule.vital
)
"""The vital rules of those that only read, which are those of the archive."""


def unfit(package: Package) -> tuple[Rule[Package], str] | None:
    """The first vital rule that does not hold, and what was seen; None for an FMU that may be loaded."""
    for rule in VITAL:
        finding = look(rule, package, most=1)
        if finding.status == "fail":
            return rule, finding.seen[0]
    return None
