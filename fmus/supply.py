"""The FMUs of the catalogue as files, built into the user's cache when they are not there yet."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import Interface
from fmukit.packaging.cached import cached
from fmus import CATALOGUE

_COMPONENTS = {component.interface.name: component for component in CATALOGUE}


def names() -> list[str]:
    """The models there are."""
    return list(_COMPONENTS)


def file(name: str) -> Path:
    """The .fmu file of the model `name`; raises BuildError or OSError when it cannot be built or kept."""
    return cached(_COMPONENTS[name])


def interface(name: str) -> Interface:
    """What the model `name` shows, which needs no build."""
    return _COMPONENTS[name].interface
