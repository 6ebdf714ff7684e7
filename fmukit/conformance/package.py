"""An FMU as a file: its archive, its description and its variables, read without unpacking or running anything.

Reading never fails on a bad FMU: what is wrong is kept (`damage`, `flaw`, `schema_errors`) for the rules to tell.
"""

from __future__ import annotations

import zipfile
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from lxml import etree

from fmukit import unpacking
from fmukit.conformance.schema import violations
from fmukit.conformance.variable import ScalarVariable, read_variables
from fmukit.unpacking import ArchiveError

DESCRIPTION = "modelDescription.xml"


@dataclass(frozen=True)
class Package:
    """One FMU file. Make it with `Package.read`.

    `damage` says why the archive cannot be read and `flaw` why its description cannot; both are empty when all is well.
    `root` is the lxml element fmiModelDescription, None if there is a damage or a flaw.
    """

    path: Path
    entries: tuple[zipfile.ZipInfo, ...]
    damage: str = ""
    xml: bytes = b""
    flaw: str = ""
    root: Any = None

    @classmethod
    def read(cls, path: Path | str) -> Package:
        """Read the file; raises FileNotFoundError if there is none."""
        path = Path(path)
        if not path.is_file():
            raise FileNotFoundError(2, "there is no such file", str(path))
        try:
            entries = tuple(unpacking.entries_of(path))
        except ArchiveError as error:
            return cls(path, (), damage=str(error))
        return _described(path, entries)

    @cached_property
    def names(self) -> frozenset[str]:
        """Names of the entries of the archive."""
        return frozenset(entry.filename for entry in self.entries)

    @cached_property
    def schema_errors(self) -> tuple[str, ...]:
        """Where the description departs from the FMI 2.0 schema."""
        return violations(self.root) if self.root is not None else ()

    @property
    def readable(self) -> bool:
        """Whether the description follows the schema, so that what it says can be relied on."""
        return self.root is not None and not self.schema_errors

    @cached_property
    def variables(self) -> tuple[ScalarVariable, ...]:
        """All variables in their order; none unless `readable`."""
        return read_variables(self.root) if self.readable else ()

    @property
    def cosimulation(self) -> Any:
        """The element CoSimulation, or None."""
        return self.root.find("CoSimulation") if self.root is not None else None

    @property
    def identifier(self) -> str:
        """modelIdentifier of co-simulation; "" if there is none."""
        return "" if self.cosimulation is None else str(self.cosimulation.get("modelIdentifier", ""))

    @property
    def guid(self) -> str:
        """The GUID; "" if there is none."""
        return "" if self.root is None else str(self.root.get("guid", ""))

    def flag(self, name: str) -> bool:
        """A capability flag of co-simulation, such as canGetAndSetFMUstate."""
        return self.cosimulation is not None and self.cosimulation.get(name) in ("true", "1")

    @property
    def step(self) -> float | None:
        """Preferred communication step [s]."""
        experiment = self.root.find("DefaultExperiment") if self.readable else None
        step = None if experiment is None else experiment.get("stepSize")
        return None if step is None else float(step)

    @property
    def python(self) -> bool:
        """Whether the FMU is made with PythonFMU, and so shares the host's interpreter."""
        return self.root is not None and str(self.root.get("generationTool", "")).startswith("PythonFMU")

    @property
    def listed_sources(self) -> list[str]:
        """The files of sources/ that the description lists."""
        listed = () if self.cosimulation is None else self.cosimulation.iterfind("SourceFiles/File")
        return [str(file.get("name")) for file in listed]

    def head(self, name: str, most: int = 4096) -> bytes:
        """The first bytes of an entry; none if it cannot be read, which the first rule tells."""
        try:
            with zipfile.ZipFile(self.path) as zipped, zipped.open(name) as source:
                return source.read(most)
        except Exception:  # zipfile raises many kinds, see fmukit.unpacking
            return b""

    def size(self, name: str) -> int:
        """How many bytes an entry says it unpacks to; 0 if there is none of that name."""
        return next((entry.file_size for entry in self.entries if entry.filename == name), 0)

    def unpack(self, folder: Path) -> None:
        """Unpack into the empty or new `folder`; raises ArchiveError on anything suspicious."""
        unpacking.unpack(self.path, folder)


def _described(path: Path, entries: tuple[zipfile.ZipInfo, ...]) -> Package:
    if DESCRIPTION not in {entry.filename for entry in entries}:
        return Package(path, entries, flaw=f"there is no {DESCRIPTION}")
    try:
        data = unpacking.read_member(path, DESCRIPTION)
    except ArchiveError as error:
        return Package(path, entries, damage=str(error))
    try:
        return Package(path, entries, xml=data, root=parse(data))
    except (ArchiveError, etree.XMLSyntaxError, UnicodeError) as error:
        return Package(path, entries, xml=data, flaw=" ".join(str(error).split()))


def parse(data: bytes) -> Any:
    """The root element; no entity is expanded, nothing else is read."""
    unpacking.refuse_entities(DESCRIPTION, data)
    return etree.fromstring(data, etree.XMLParser(resolve_entities=False, no_network=True, remove_comments=True))
