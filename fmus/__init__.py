"""The components, and nothing else. `CATALOGUE` is the one list of all FMUs; build, checks, docs and tests use it."""

from fmukit.kernel import Component

CATALOGUE: tuple[Component, ...] = ()
