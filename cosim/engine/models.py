"""Where models given by name come from: installed packages offer FMUs through the entry point group `cosim.models`.

An entry names a module with two functions: `names()` gives the models it has, `file(name)` the .fmu file of one. A
third, `interface(name)`, may tell what can be set of one before its file is there.
"""

from __future__ import annotations

from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Protocol

from cosim.errors import CosimError, unknown
from cosim.model.declared import declared_face
from cosim.model.face import Face
from fmukit.errors import BuildError, because
from fmukit.store import cache_folder

GROUP = "cosim.models"


class Supplier(Protocol):
    """A module that offers models."""

    def names(self) -> list[str]:
        """The models it has."""

    def file(self, name: str) -> Path:
        """The .fmu file of one of them; raises BuildError or OSError when it cannot be made."""


def find(model: str) -> Path:
    """The .fmu file of the model called `model`; raises CosimError if nobody offers it or it cannot be built."""
    suppliers = [_supplier(entry) for entry in entry_points(group=GROUP)]
    for supplier in suppliers:
        if model in supplier.names():
            return _file(supplier, model)
    raise unknown("model", model, [name for supplier in suppliers for name in supplier.names()])


def declared(model: str) -> Face | None:
    """What can be set of a model, without its .fmu file; None where only the file tells."""
    for entry in entry_points(group=GROUP):
        supplier = _supplier(entry)
        if hasattr(supplier, "interface") and model in supplier.names():
            return declared_face(supplier.interface(model))
    return None


def _supplier(entry: EntryPoint) -> Supplier:
    try:
        supplier: Supplier = entry.load()
    except (ImportError, AttributeError) as error:
        raise CosimError(f"the models of {entry.value} cannot be offered: {error}") from None
    return supplier


def _file(supplier: Supplier, model: str) -> Path:
    try:
        return supplier.file(model)
    except BuildError as error:
        raise CosimError(f"cannot build {model}: {error}") from None
    except OSError as error:
        where = error.filename or cache_folder()
        remedy = "make room there, or set XDG_CACHE_HOME to a folder you can write into"
        raise CosimError(f"cannot keep the built {model} in {where}: {because(error)}; {remedy}") from None
