"""One good FMU and how to break it so that a single rule fails: `BROKEN` has (rule, words of its sentence, how).

Each group of rules has a module, as in fmukit/conformance; importing it adds to the table.
"""

from broken import archive, description, structure, types, units, values, variables  # noqa: F401
from broken.making import BROKEN, XML, Broken

__all__ = ["BROKEN", "XML", "Broken"]
