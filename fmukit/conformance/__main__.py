"""`python -m fmukit.conformance` prints the table of rules in docs/conformance-rules.md."""

from fmukit.conformance.check import every_rule
from fmukit.conformance.report import rule_table

print(rule_table(every_rule()))
