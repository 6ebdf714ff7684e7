"""Events of a file: values set during the run, and faults of signals."""

from __future__ import annotations

import csv
import math
from collections.abc import Callable, Iterable
from importlib.metadata import entry_points
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

from cosim.errors import CosimError, unknown
from cosim.model.effects import Delay, Drop, Effect, Freeze, Linear, Noise, Override, Ramp, Table
from cosim.model.fault import Fault, comparisons
from cosim.model.system import System
from cosim.system_file.decoding import read_form
from cosim.system_file.form import EventForm, EventsForm
from fmukit.errors import because

GROUP = "cosim.events"
"""The entry point group through which packages offer files of events: modules beside which they lie."""
_EFFECTS = ("override", "ramp_to", "table", "scale", "bias", "noise", "freeze", "delay", "drop")


def add_events_of(name: str, system: System) -> None:
    """Add what a file says, or one that a package offers by its name without suffix; raises CosimError."""
    file = Path(name) if name.endswith(".toml") else _offered(name)
    form = read_form(file, EventsForm)
    for signal, value in form.parameters.items():
        system.set(signal, value)
    add_events(system, form.events, file)


def add_events(system: System, events: Iterable[EventForm], file: Path) -> None:
    """Add events read from `file`, beside which their tables lie; raises CosimError with the number of a wrong one."""
    for number, event in enumerate(events, start=1):
        _add(system, event, f"{file}, event {number}", file.parent)


def _add(system: System, event: EventForm, where: str, folder: Path) -> None:
    given = [
        key for key in _EFFECTS if getattr(event, key) is not None and (key, getattr(event, key)) != ("freeze", False)
    ]
    if event.set is not None:
        if event.signal is not None or given or event.when or event.until != math.inf:
            raise CosimError(f"{where}: set stands alone with time; give other effects a signal")
        for signal, value in event.set.items():
            system.at(event.time, signal, value)
        return
    if event.signal is None or not given:
        raise CosimError(f"{where}: give set, or a signal and one of {', '.join(_EFFECTS)}")
    kinds = [key for key in given if key not in ("scale", "bias")]
    if len(kinds) > 1 or (kinds and len(given) > 1):
        raise CosimError(f"{where}: {' and '.join(given)} are two effects; give an event to each")
    try:
        effect = _effect(event, given[0], folder)
        system.fail(Fault(event.signal, effect, event.time, event.until, comparisons(event.when)))
    except CosimError as error:
        raise CosimError(f"{where}: {error}") from None


def _effect(event: EventForm, kind: str, folder: Path) -> Effect:
    value = getattr(event, kind)
    if kind in ("scale", "bias"):
        if not all(map(math.isfinite, filter(None, (event.scale, event.bias)))):
            raise CosimError("scale and bias must be finite numbers")
        return Linear(1.0 if event.scale is None else event.scale, event.bias or 0.0)
    made: dict[str, Callable[[], Effect]] = {
        "override": lambda: Override(float(value)),
        "ramp_to": lambda: Ramp(value, _positive(event.over, "over")),
        "table": lambda: _checked(value, kind) if isinstance(value, list) else _table(folder / value),
        "noise": lambda: Noise(_positive(value, kind)),
        "freeze": Freeze,
        "delay": lambda: Delay(_positive(value, kind)),
        "drop": lambda: Drop(_probability(value)),
    }
    return made[kind]()


def _probability(value: float) -> float:
    if not 0.0 <= value <= 1.0:
        raise CosimError(f"drop is {value:g}; give the probability that a value is lost, 0 to 1")
    return value


def _positive(value: float | None, key: str) -> float:
    if value is None or not (math.isfinite(value) and value > 0.0):
        raise CosimError(f"{key} is {'missing' if value is None else f'{value:g}'}; give a positive number")
    return value


def _table(file: Path) -> Table:
    """Two columns, time [s] and value, after one line with their names."""
    try:
        with file.open(encoding="utf-8-sig", newline="") as opened:
            lines = [line for line in csv.reader(opened) if line]
        rows = [[float(cell) for cell in line] for line in lines[1:]]
    except OSError as error:
        raise CosimError(f"{file} cannot be read: {because(error)}") from None
    except (ValueError, csv.Error):
        raise CosimError(f"{file} is no table: give a line of names, then lines of time and value") from None
    return _checked(rows, str(file))


def _checked(rows: list[list[float]], name: str) -> Table:
    if not rows or any(len(row) != 2 or not all(map(math.isfinite, row)) for row in rows):
        raise CosimError(f"{name} is no table: give rows of time and value")
    times, values = zip(*rows, strict=True)
    if any(after <= before for before, after in pairwise(times)):
        raise CosimError(f"{name}: the times must increase from row to row")
    return Table(times, values)


def offered() -> dict[str, Path]:
    """The files of events that packages offer, by name."""
    folders = [Path(str(files(entry.value))) for entry in entry_points(group=GROUP)]
    return {file.stem: file for folder in folders for file in sorted(folder.glob("*.toml"))}


def _offered(name: str) -> Path:
    known = offered()
    if name not in known:
        raise unknown("events", name, known, "or give the path of a .toml file")
    return known[name]
