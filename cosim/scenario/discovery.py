"""The scenarios that installed packages offer, through the entry point group `cosim.scenarios`.

A package of your own adds one by naming a `Scenario` in its pyproject.toml:

    [project.entry-points."cosim.scenarios"]
    my-scenario = "my_package.my_module:MY_SCENARIO"
"""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points

from cosim.errors import CosimError, unknown
from cosim.scenario.definition import Scenario

GROUP = "cosim.scenarios"


def names() -> list[str]:
    """The names of all scenarios, sorted."""
    return sorted(_offered())


def load(name: str) -> Scenario:
    """The scenario called `name`; raises CosimError with the closest names, or when its package is broken."""
    offered = _offered()
    if name not in offered:
        raise unknown("scenario", name, offered)
    try:
        scenario = offered[name].load()
    except (ImportError, AttributeError) as error:
        raise CosimError(f"the scenario {name} of {offered[name].value} cannot be loaded: {error}") from None
    if not isinstance(scenario, Scenario):
        raise CosimError(f"the scenario {name}: {offered[name].value} is no Scenario but a {type(scenario).__name__}")
    return scenario


def _offered() -> dict[str, EntryPoint]:
    return {entry.name: entry for entry in entry_points(group=GROUP)}
