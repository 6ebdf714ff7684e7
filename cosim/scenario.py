"""What a scenario is: metadata, settings, and the function that builds its system."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cosim.errors import CosimError, unknown
from cosim.results import Results
from cosim.system import System

Settings = Mapping[str, str]
PREFIX = "scenario."


@dataclass(frozen=True, slots=True)
class Setting:
    """One choice a scenario offers as `--set scenario.NAME=...`."""

    default: str
    choices: tuple[str, ...]
    description: str


@dataclass(frozen=True, slots=True)
class Scenario:
    """`figures` names what of the thesis it reproduces; `find` gives the .fmu file of a catalogue name.

    `complete` derives what follows from the user's values once they are set, `draw` makes a picture of the results.
    """

    name: str
    title: str
    figures: str
    stop_time: float
    build: Callable[[Settings], System]
    find: Callable[[str], Path]
    complete: Callable[[System], None] = lambda _system: None
    metrics: Callable[[Results], dict[str, float]] = lambda _results: {}
    draw: Callable[[Results, Path, str], None] | None = None
    settings: Mapping[str, Setting] = field(default_factory=dict)


def configured(scenario: Scenario, assignments: Sequence[tuple[str, str]]) -> System:
    """The system of `scenario` with all assignments applied: its own settings, then instance variables."""
    settings = {name: setting.default for name, setting in scenario.settings.items()}
    for name, value in assignments:
        if name.startswith(PREFIX):
            _apply(scenario, settings, name.removeprefix(PREFIX), value)
    system = scenario.build(settings)
    for name, value in assignments:
        if not name.startswith(PREFIX):
            system.set(name, value)
    scenario.complete(system)
    return system


def _apply(scenario: Scenario, settings: dict[str, str], name: str, value: str) -> None:
    setting = scenario.settings.get(name)
    if setting is None:
        raise unknown(f"setting of {scenario.name}", name, scenario.settings)
    if value not in setting.choices:
        raise CosimError(f"scenario.{name} = {value!r} is not one of {', '.join(setting.choices)}")
    settings[name] = value
