"""What the runtime knows of its FMU: the slots of the buffer, read from `interface.json`.

The buffer of an instance is `[parameters | inputs | outputs | derived | states]`, all doubles; the value reference of
a variable is its slot. `fault` is the last output. String parameters keep an unused slot.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

LARGEST = 1.7976931348623157e308


@dataclass(frozen=True, slots=True)
class Port:
    """One variable: its limits are finite, so that a comparison with them also refuses NaN and infinity."""

    name: str
    type: str
    causality: str
    start: Any
    low: float
    high: float
    unit: str


@dataclass(frozen=True, slots=True)
class TableFile:
    """The CSV file to read at initialisation: its path is the value of the String parameter at `slot`."""

    slot: int
    columns: tuple[str, ...]
    rows: int
    increasing: bool = True


@dataclass(frozen=True, slots=True)
class Program:
    """The Python modules that stand for the kernel, the first being the one called; see `fmukit/python_kernel.py`.

    `packages` are pairs of a name and the least version; `derived` is the number of derived values.
    """

    modules: tuple[str, ...]
    libraries: tuple[str, ...]
    packages: tuple[tuple[str, str], ...]
    derived: int


@dataclass(frozen=True, slots=True)
class Advice:
    """A sentence for the user when the output at `slot` is above 0.5 after initialisation.

    `values` are pairs of a placeholder in the text and the slot of the parameter that takes its place.
    """

    slot: int
    text: str
    values: tuple[tuple[str, int], ...]

    def given(self, buffer: Sequence[float]) -> str:
        """The sentence with the values in `buffer`; empty where it does not apply."""
        if not buffer[self.slot] > 0.5:
            return ""
        text = self.text
        for placeholder, slot in self.values:
            text = text.replace(placeholder, f"{buffer[slot]:g}")
        return text


@dataclass(frozen=True, slots=True)
class Description:
    """One FMU: `size` is that of the whole buffer, `period_slot` and `seed_slot` are -1 where there is none.

    `step` and `max_substep` in s; `hash` names the package and so the kernel a saved state belongs to.
    """

    name: str
    hash: str
    continuous: bool
    step: float
    max_substep: float
    ports: tuple[Port, ...]
    size: int
    period_slot: int
    seed_slot: int
    table: TableFile | None
    program: Program | None
    advice: tuple[Advice, ...]

    @property
    def fault(self) -> int:
        """Slot of the output `fault`."""
        return len(self.ports) - 1

    @staticmethod
    def read(path: Path) -> Description:
        """The description in the `interface.json` at `path`."""
        raw = json.loads(path.read_text("utf-8"))
        ports = tuple(_port(entry) for entry in raw["variables"])
        slots = {port.name: slot for slot, port in enumerate(ports)}
        table, program = raw["table"], raw["program"]
        return Description(
            name=raw["name"],
            hash=path.parent.name,
            continuous=raw["kind"] == "continuous",
            step=raw["step"],
            max_substep=LARGEST if raw["max_substep"] is None else raw["max_substep"],
            ports=ports,
            size=len(ports) + raw["derived"] + raw["states"],
            period_slot=slots.get("sample_period", -1),
            seed_slot=slots.get("seed", -1),
            table=table
            and TableFile(slots[table["parameter"]], tuple(table["columns"]), table["rows"], table["increasing"]),
            program=program and _program(program, raw["derived"]),
            advice=tuple(_advice(text, slots[output], slots) for output, text in raw["advice"]),
        )


def _port(entry: list[Any]) -> Port:
    name, type_, causality, start, low, high, unit = entry
    low, high = -LARGEST if low is None else low, LARGEST if high is None else high
    return Port(name, type_, causality, start, low, high, unit)


def _advice(text: str, slot: int, slots: dict[str, int]) -> Advice:
    names = re.findall(r"\{([^{}]*)}", text)
    return Advice(slot, text, tuple((f"{{{name}}}", slots[name]) for name in names))


def _program(entry: dict[str, Any], derived: int) -> Program:
    packages = tuple((name, least) for name, least in entry["packages"])
    return Program(tuple(entry["modules"]), tuple(entry["libraries"]), packages, derived)
