"""The models of a system: unpacked once each into a temporary folder, then instantiated as often as needed."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Self

from fmpy import platform, sharedLibraryExtension

from cosim.engine.fmu import FmuSlave, Library
from cosim.engine.slave import Slave
from cosim.errors import CosimError
from cosim.model.assembly import Node
from cosim.model.face import Face, read_face
from cosim.model.system import System
from fmukit.conformance.package import Package
from fmukit.conformance.vital import unfit
from fmukit.errors import UserError, because
from fmukit.places import unpacking_folder
from fmukit.unpacking import ArchiveError, unpack

Find = Callable[[str], Path]


class Loader:
    """A context: slaves and unpacked FMUs live until it ends. `find` gives the .fmu file of a catalogue name."""

    def __init__(self, find: Find) -> None:
        self._find = find
        self._root = Path()
        self._models: dict[str, Library] = {}
        self._slaves: list[Slave] = []

    def __enter__(self) -> Self:
        try:
            self._root = Path(tempfile.mkdtemp(prefix="cosim-", dir=unpacking_folder()))
        except UserError as error:
            raise CosimError(str(error)) from None
        except OSError as error:
            raise CosimError(f"no folder to unpack FMUs into: {because(error)}; set TMPDIR to one") from None
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, tb: TracebackType | None) -> None:
        for slave in reversed(self._slaves):
            slave.close()
        shutil.rmtree(self._root, ignore_errors=True)

    def faces(self, system: System) -> dict[str, Face]:
        """The face of every instance's model."""
        return {name: self._model(instance.model).face for name, instance in system.instances.items()}

    def slaves(self, nodes: Mapping[str, Node]) -> dict[str, Slave]:
        """One slave per node, instantiated but not initialised."""
        return {name: self._instantiate(name, self._model(node.model)) for name, node in nodes.items()}

    def file(self, model: str) -> Path:
        """The .fmu file of a model: the path itself, or where `find` has the catalogue's."""
        return Path(model) if model.endswith(".fmu") else self._find(model)

    def _instantiate(self, name: str, library: Library) -> Slave:
        slave = FmuSlave(name, library)
        self._slaves.append(slave)
        return slave

    def _model(self, model: str) -> Library:
        if model not in self._models:
            path = self.file(model)
            folder = self._root / str(len(self._models))
            _unpack(path, folder)
            face = read_face(folder, path)
            _has_binary(folder, face, path)
            _is_fit(path)
            self._models[model] = Library(face, folder)
        return self._models[model]


def _unpack(path: Path, folder: Path) -> None:
    try:
        unpack(path, folder)
    except ArchiveError as error:
        raise CosimError(str(error)) from None


def _is_fit(path: Path) -> None:
    """Raises CosimError for what would take this process down; `fmus check` goes by the same rules."""
    broken = unfit(Package.read(path))
    if broken:
        rule, seen = broken
        raise CosimError(f"{path} cannot be loaded: {seen}; {rule.remedy[0].lower()}{rule.remedy[1:].rstrip('.')}")


def _has_binary(folder: Path, face: Face, origin: Path) -> None:
    if (folder / "binaries" / platform / (face.identifier + sharedLibraryExtension)).is_file():
        return
    needed = f"{face.identifier}{sharedLibraryExtension}"
    here = sorted(path.name for path in (folder / "binaries" / platform).glob("*"))
    if here:
        raise CosimError(f"{origin} has {', '.join(here)} for {platform}, but its modelIdentifier asks for {needed}")
    present = sorted(path.name for path in (folder / "binaries").glob("*")) or ["none"]
    raise CosimError(f"{origin} has no binary for {platform}; it has {', '.join(present)}")
