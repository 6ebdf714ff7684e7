"""`python -m fmukit.conformance` prints the table of rules in the README."""

from fmukit.conformance.report import rule_table
from fmukit.conformance.rulebook import ALL

print(rule_table(ALL))
