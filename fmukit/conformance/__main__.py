"""`python -m fmukit.conformance` prints the table of rules in docs/conformance-rules.md."""

from fmukit.conformance.report import rule_table
from fmukit.conformance.rulebook import ALL

print(rule_table(ALL))
