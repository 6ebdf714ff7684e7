"""All rules, in the order they are applied: those that read the FMU, and those that run it."""

from __future__ import annotations

from typing import Any

from fmukit.conformance import (
    archive_rules,
    behaviour_rules,
    binary_rules,
    growth_rules,
    isolation_rules,
    lifecycle_rules,
    refusal_rules,
    state_rules,
    value_rules,
)
from fmukit.conformance.bench import Bench
from fmukit.conformance.package import Package
from fmukit.conformance.rule import Rule, in_order
from fmukit.conformance.xml_rules import description, structure, types, units, values, variables

READING: tuple[Rule[Package], ...] = in_order(
    archive_rules.FILE,
    archive_rules.ENTRIES,
    binary_rules.RULES,
    description.DOCUMENT,
    description.RULES,
    units.RULES,
    types.RULES,
    variables.RULES,
    values.RULES,
    structure.RULES,
)
RUNNING: tuple[Rule[Bench], ...] = in_order(
    lifecycle_rules.RULES,
    refusal_rules.RULES,
    behaviour_rules.RULES,
    state_rules.RULES,
    value_rules.RULES,
    growth_rules.RULES,
    isolation_rules.RULES,
)
ALL: tuple[Rule[Any], ...] = (*READING, *RUNNING)
