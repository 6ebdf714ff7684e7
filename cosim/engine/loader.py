"""The models of a system: unpacked once each into a temporary folder, then instantiated as often as needed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

from fmpy import platform, sharedLibraryExtension

from cosim.engine.fmu import FmuSlave, Library
from cosim.engine.folder import temporary_folder
from cosim.engine.isolation.process import Process
from cosim.engine.isolation.proxy import IsolatedSlave
from cosim.engine.slave import Slave
from cosim.errors import CosimError
from cosim.model.face import Face, read_face
from cosim.model.node import Node
from cosim.model.system import System
from fmukit.conformance.package import Package
from fmukit.conformance.vital import unfit
from fmukit.unpacking import ArchiveError, unpack

Find = Callable[[str], Path]
ISOLATION_TIMEOUT = 60.0
"""[s] of wall time that a call of an isolated instance may take unless the user says otherwise."""


class Loader:
    """A context: slaves and unpacked FMUs live until it ends. `find` gives the .fmu file of a catalogue name.

    A call of an isolated instance may take `timeout` [s].
    """

    def __init__(self, find: Find, timeout: float = ISOLATION_TIMEOUT) -> None:
        self._find, self._timeout = find, timeout
        self._root, self._held = Path(), ExitStack()
        self._files: dict[str, Path] = {}
        self._models: dict[str, Library] = {}
        self._slaves: list[Slave] = []

    def __enter__(self) -> Self:
        self._root = self._held.enter_context(temporary_folder())
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, tb: TracebackType | None) -> None:
        for slave in reversed(self._slaves):
            slave.close()
        self._held.close()

    def faces(self, system: System) -> dict[str, Face]:
        """The face of every instance's model."""
        self._files.update(system.files)
        return {name: self._model(instance.model).face for name, instance in system.instances.items()}

    def slaves(self, nodes: Mapping[str, Node]) -> dict[str, Slave]:
        """One slave per node, instantiated but not initialised; the isolated ones have been started all at once."""
        with ExitStack() as unused:
            started = {name: Process(self._timeout) for name, node in nodes.items() if node.isolated}
            for process in started.values():
                unused.callback(process.close)
            made = {
                name: self._instantiate(name, self._model(node.model), started.get(name))
                for name, node in nodes.items()
            }
            unused.pop_all()
        return made

    def file(self, model: str) -> Path:
        """The .fmu file of a model: its system's own, the path itself, or where `find` has the catalogue's."""
        if model in self._files:
            return self._files[model]
        return Path(model) if model.endswith(".fmu") else self._find(model)

    def _instantiate(self, name: str, library: Library, process: Process | None) -> Slave:
        slave: Slave = FmuSlave(name, library) if process is None else IsolatedSlave(name, library, process)
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
