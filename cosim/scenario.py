"""What a scenario is: metadata, settings, and the function that builds its system."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cosim.errors import CosimError, unknown
from cosim.model.system import System
from cosim.results.reading import Results

Settings = Mapping[str, Any]
"""Values by the name of the setting: the text of a choice, the float of a number."""
PREFIX = "scenario."


@dataclass(frozen=True, slots=True)
class Setting:
    """One choice a scenario offers as `--set scenario.NAME=...`."""

    default: str
    choices: tuple[str, ...]
    description: str

    @property
    def offered(self) -> str:
        """What may be given, for a table."""
        return "|".join(self.choices)

    def read(self, name: str, text: str) -> str:
        """The value of `text`; raises CosimError when it is not one of the choices."""
        if text not in self.choices:
            raise CosimError(f"{PREFIX}{name} = {text!r} is not one of {', '.join(self.choices)}")
        return text


@dataclass(frozen=True, slots=True)
class NumberSetting:
    """One number a scenario offers as `--set scenario.NAME=...`, within limits that are part of the range.

    `whole` numbers only: a count.
    """

    default: float
    minimum: float
    maximum: float
    unit: str
    description: str
    whole: bool = False

    @property
    def offered(self) -> str:
        """What may be given, for a table."""
        return f"{self.minimum:g} ... {self.maximum:g}{self._unit}"

    def read(self, name: str, text: str) -> float:
        """The value of `text`; raises CosimError when it is no number or beyond the limits."""
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not math.isfinite(number):
            raise CosimError(f"{PREFIX}{name} = {text!r} is not a finite number; give one in {self.offered}")
        if not self.minimum <= number <= self.maximum:
            raise CosimError(f"{PREFIX}{name} = {number:g}{self._unit} is outside its range {self.offered}")
        if self.whole and number != round(number):
            raise CosimError(f"{PREFIX}{name} = {text!r} is not a whole number; give one in {self.offered}")
        return number

    @property
    def _unit(self) -> str:
        return "" if self.unit == "1" else f" {self.unit}"


@dataclass(frozen=True, slots=True)
class Scenario:
    """`figures` names what of the thesis it reproduces; `find` gives the .fmu file of a catalogue name.

    `complete(system, settings)` derives what follows from the user's values once they are set, `draw` makes a picture
    of the results. A row is recorded every `record_every` [s]; 0 is at every tick. Signals that match a pattern of
    `unrecorded`, such as *.tyre_force_x.fl, are left out of the results.
    """

    name: str
    title: str
    figures: str
    stop_time: float
    build: Callable[[Settings], System]
    find: Callable[[str], Path]
    complete: Callable[[System, Settings], None] = lambda _system, _settings: None
    metrics: Callable[[Results], dict[str, float]] = lambda _results: {}
    draw: Callable[[Results, Path, str], None] | None = None
    settings: Mapping[str, Setting | NumberSetting] = field(default_factory=dict)
    record_every: float = 0.0
    unrecorded: Sequence[str] = ()


def chosen(scenario: Scenario, assignments: Sequence[tuple[str, str]]) -> Settings:
    """The settings of `scenario` that the assignments make; raises CosimError for one it has not."""
    settings: dict[str, Any] = {name: setting.default for name, setting in scenario.settings.items()}
    for name, value in assignments:
        if name.startswith(PREFIX):
            _apply(scenario, settings, name.removeprefix(PREFIX), value)
    return settings


def configured(scenario: Scenario, assignments: Sequence[tuple[str, str]]) -> System:
    """The system of `scenario` with all assignments applied: its own settings, then instance variables."""
    settings = chosen(scenario, assignments)
    system = scenario.build(settings)
    for name, value in assignments:
        if not name.startswith(PREFIX):
            system.set(name, value)
    scenario.complete(system, settings)
    return system


def _apply(scenario: Scenario, settings: dict[str, Any], name: str, value: str) -> None:
    setting = scenario.settings.get(name)
    if setting is None:
        raise unknown(f"setting of {scenario.name}", name, scenario.settings)
    settings[name] = setting.read(name, value)
