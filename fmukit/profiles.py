"""Named parameter sets of a component, kept in a `profiles.toml` beside its `parameters.toml`.

The file names its `default`, whose values are the component's start values and are therefore not repeated, and has one
table per further profile: entries `"parameter" = {value = 1.0, source = "..."}`.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from fmukit.interface import Interface


@dataclass(frozen=True, slots=True)
class Profiles:
    """Parameter sets by name; every set holds the same parameters."""

    owner: str
    sets: dict[str, dict[str, float]]

    def __getitem__(self, name: str) -> dict[str, float]:
        """A copy of the set `name`; ValueError lists the known names."""
        if name not in self.sets:
            raise ValueError(f"{self.owner} has no profile {name!r}; choose one of {', '.join(sorted(self.sets))}")
        return dict(self.sets[name])


def load_profiles(path: Path, interface: Interface) -> Profiles:
    """Profiles of `path` for `interface`; ValueError names an unknown parameter or a value without a source."""
    document = tomllib.loads(path.read_text("utf-8"))
    default = document.pop("default")
    starts = {v.name: float(v.start) for v in interface.select("parameter") if v.type == "Real"}
    changed = {name: _values(path, name, table, starts) for name, table in document.items()}
    keys = {key for table in changed.values() for key in table}
    base = {key: starts[key] for key in starts if key in keys}
    return Profiles(interface.name, {default: base, **{name: base | table for name, table in changed.items()}})


def _values(path: Path, name: str, table: dict[str, dict[str, float]], starts: dict[str, float]) -> dict[str, float]:
    for key, entry in table.items():
        if key not in starts:
            raise ValueError(f"{path.name}: profile {name} sets {key}, which is not a Real parameter")
        if entry.keys() != {"value", "source"}:
            raise ValueError(f"{path.name}: {key} of profile {name} needs a value and a source, nothing else")
    return {key: float(entry["value"]) for key, entry in table.items()}
