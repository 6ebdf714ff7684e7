"""Parameters kept in a TOML file beside the model, each with its unit and its source."""

from __future__ import annotations

import tomllib
from pathlib import Path

from fmukit.interface.variable import Variable, parameter

_KEYS = {"value", "unit", "min", "max", "description", "source"}


def load_parameters(path: Path) -> tuple[Variable, ...]:
    """Parameters from a TOML file of entries `"name" = {value, unit, description, source, min, max}`.

    Raises ValueError naming the file and the entry when a key is missing or unknown.
    """
    return tuple(_from_toml(path, name, entry) for name, entry in tomllib.loads(path.read_text("utf-8")).items())


def _from_toml(path: Path, name: str, entry: dict[str, object]) -> Variable:
    if not isinstance(entry, dict):
        raise ValueError(f'{path.name}: {name} must be a table like {{value = 1.0, unit = "m", ...}}')
    unknown, missing = entry.keys() - _KEYS, {"value", "unit", "description", "source"} - entry.keys()
    if unknown or missing:
        raise ValueError(f"{path.name}: {name} has unknown keys {sorted(unknown)} and lacks {sorted(missing)}")
    value = entry["value"]
    start = value if isinstance(value, bool | str) else float(value)  # type: ignore[arg-type]
    return parameter(
        name,
        str(entry["unit"]),
        str(entry["description"]),
        start,
        minimum=entry.get("min"),  # type: ignore[arg-type]
        maximum=entry.get("max"),  # type: ignore[arg-type]
        source=str(entry["source"]),
    )
