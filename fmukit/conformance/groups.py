"""The rules that run the FMU, in the order they are applied; importing their modules numbers them."""

from __future__ import annotations

from fmukit.conformance.bench import Bench
from fmukit.conformance.lifecycle_rules import L
from fmukit.conformance.rule import Rule

from fmukit.conformance import refusal_rules  # isort: skip
from fmukit.conformance.behaviour_rules import B  # isort: skip
from fmukit.conformance import state_rules, value_rules, growth_rules  # isort: skip
from fmukit.conformance.isolation_rules import I  # isort: skip

RULES: list[Rule[Bench]] = [*L.rules, *B.rules, *I.rules]
FOUNDATION = ("L1", "L2")
"""Without these nothing else can be looked at."""

__all__ = ["FOUNDATION", "RULES", "growth_rules", "refusal_rules", "state_rules", "value_rules"]
