"""The scenarios, one module each with a `SCENARIO`; found by `names` and `load`; `_` modules help them."""

from __future__ import annotations

import pkgutil
from importlib import import_module

from cosim.errors import unknown
from cosim.scenario import Scenario


def names() -> list[str]:
    """The names of all scenarios."""
    found = (module.name for module in pkgutil.iter_modules(__path__))
    return [name.replace("_", "-") for name in found if not name.startswith("_")]


def load(name: str) -> Scenario:
    """The scenario called `name`; raises CosimError with the closest names."""
    if name not in names():
        raise unknown("scenario", name, names())
    scenario: Scenario = import_module(f"{__name__}.{name.replace('-', '_')}").SCENARIO
    return scenario
