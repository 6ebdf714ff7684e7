"""The settings a scenario offers: choices and numbers, given as `--set scenario.NAME=...`."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from cosim.errors import CosimError, unknown

Settings = Mapping[str, Any]
"""Values by the name of the setting: the text of a choice, the float of a number, the int of a whole one."""
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
        return int(number) if self.whole else number

    @property
    def _unit(self) -> str:
        return "" if self.unit == "1" else f" {self.unit}"


def chosen(
    owner: str, offered: Mapping[str, Setting | NumberSetting], assignments: Sequence[tuple[str, str]]
) -> Settings:
    """The settings that the assignments (name, text) of the form `scenario.NAME` make, the others at their defaults.

    `offered` are the settings of the scenario named `owner`. Raises CosimError for one it does not offer.
    """
    settings: dict[str, Any] = {
        name: int(setting.default) if getattr(setting, "whole", False) else setting.default
        for name, setting in offered.items()
    }
    for name, text in assignments:
        if name.startswith(PREFIX):
            setting = offered.get(name.removeprefix(PREFIX))
            if setting is None:
                raise unknown(f"setting of {owner}", name.removeprefix(PREFIX), offered)
            settings[name.removeprefix(PREFIX)] = setting.read(name.removeprefix(PREFIX), text)
    return settings
