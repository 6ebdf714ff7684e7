"""What the runtime knows of its FMU: the slots of the buffer, read from `interface.json`.

The buffer of an instance is `[parameters | inputs | outputs | derived | states]`, all doubles; the value reference of
a variable is its slot. `fault` is the last output. String parameters keep an unused slot.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

LARGEST = 1.7976931348623157e308
Entry = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Scalar:
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
    """The CSV file to read at initialisation: its path is the value of the String parameter at `slot`.

    `names` are other names that its columns may have, and the columns they stand for.
    """

    slot: int
    columns: tuple[str, ...]
    rows: int
    increasing: bool = True
    names: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class ScriptProgram:
    """The Python modules that stand for the kernel, the first being the one called; see `fmukit/python_kernel.py`.

    `packages` are pairs of a name and the least version; `derived` is the number of derived values.
    """

    modules: tuple[str, ...]
    libraries: tuple[str, ...]
    packages: tuple[tuple[str, str], ...]
    derived: int


@dataclass(frozen=True, slots=True)
class Remark:
    """A sentence for the user when the output at `slot` is above 0.5.

    `values` are pairs of a placeholder in the text and the slot of the parameter that takes its place.
    """

    slot: int
    text: str
    values: tuple[tuple[str, int], ...]

    def made(self, buffer: Sequence[float]) -> str:
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

    `step` and `max_substep` in s; `most` is how many substeps or samples a step may have; `hash` names the package and
    so the kernel a saved state belongs to.
    """

    name: str
    hash: str
    continuous: bool
    step: float
    max_substep: float
    most: int
    scalars: tuple[Scalar, ...]
    size: int
    period_slot: int
    seed_slot: int
    table: TableFile | None
    program: ScriptProgram | None
    remarks: tuple[Remark, ...]

    @property
    def fault(self) -> int:
        """Slot of the output `fault`."""
        return len(self.scalars) - 1

    @staticmethod
    def read(path: Path) -> Description:
        """The description in the `interface.json` at `path`."""
        raw = json.loads(path.read_text("utf-8"))
        scalars = tuple(map(_scalar, raw["variables"]))
        slots = {scalar.name: slot for slot, scalar in enumerate(scalars)}
        return Description(
            name=raw["name"],
            hash=path.parent.name,
            continuous=raw["kind"] == "continuous",
            step=raw["step"],
            max_substep=LARGEST if raw["max_substep"] is None else raw["max_substep"],
            most=raw["most"],
            scalars=scalars,
            size=len(scalars) + raw["derived"] + raw["states"],
            period_slot=slots.get("sample_period", -1),
            seed_slot=slots.get("seed", -1),
            table=_table(raw["table"], slots) if raw["table"] else None,
            program=_program(raw["program"], raw["derived"]) if raw["program"] else None,
            remarks=tuple(_remark(entry, slots) for entry in raw["advice"]),
        )


def _scalar(entry: Entry) -> Scalar:
    low, high = entry["minimum"], entry["maximum"]
    return Scalar(
        name=entry["name"],
        type=entry["type"],
        causality=entry["causality"],
        start=entry["start"],
        low=-LARGEST if low is None else low,
        high=LARGEST if high is None else high,
        unit=entry["unit"],
    )


def _table(entry: Entry, slots: Mapping[str, int]) -> TableFile:
    columns, names = tuple(entry["columns"]), tuple(entry["names"].items())
    return TableFile(slots[entry["parameter"]], columns, entry["rows"], entry["increasing"], names)


def _remark(entry: Entry, slots: Mapping[str, int]) -> Remark:
    text = entry["text"]
    names = re.findall(r"\{([^{}]*)}", text)
    return Remark(slots[entry["output"]], text, tuple((f"{{{name}}}", slots[name]) for name in names))


def _program(entry: Entry, derived: int) -> ScriptProgram:
    packages = tuple(entry["packages"].items())
    return ScriptProgram(tuple(entry["modules"]), tuple(entry["libraries"]), packages, derived)
