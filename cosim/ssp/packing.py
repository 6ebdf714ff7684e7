"""FMUs as they travel in an exported system: with the tables that String parameters of their instances name."""

from __future__ import annotations

import io
import logging
import re
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cosim.model.assembly import Node
from fmukit.packing import pack

_LOOKS_INSIDE = re.compile(r"resources/fmu_\w+/runtime/table\.py")
_LOG = logging.getLogger("cosim")


@dataclass(frozen=True, slots=True)
class Model:
    """A model's file and the name it has in resources/; `tables` by name go into the FMU's own resources."""

    file: Path
    name: str
    tables: dict[str, bytes] = field(default_factory=dict)


def take_tables_along(node: Node, model: Model) -> None:
    """Tables of the node go into its FMU, and the node names them by their mere name, which means just that.

    Of an FMU that would not look there nothing is packed: the path stays, and is told.
    """
    for name, value in node.values.items():
        if node.face.ports[name].type != "String" or not Path(str(value)).is_file():
            continue
        own = _members(model.file)
        if not any(_LOOKS_INSIDE.fullmatch(member) for member in own):
            _LOG.warning("%s.%s stays the path %s, as %s cannot bring it along", node.name, name, value, model.name)
            continue
        content = Path(str(value)).read_bytes()
        known = dict.fromkeys((member.removeprefix("resources/") for member in own), b"") | model.tables
        node.values[name] = _free_name(known, Path(str(value)), content)
        model.tables[str(node.values[name])] = content


def packed(model: Model) -> bytes:
    """The FMU as it is, or with its tables added."""
    data = model.file.read_bytes()
    if not model.tables:
        return data
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    return pack(members | {f"resources/{name}": content for name, content in model.tables.items()})


def _free_name(known: Mapping[str, bytes], path: Path, content: bytes) -> str:
    """The file's own name, numbered when another file has it."""
    name, number = path.name, 1
    while known.get(name, content) != content:
        number += 1
        name = f"{path.stem}-{number}{path.suffix}"
    return name


def _members(fmu: Path) -> list[str]:
    with zipfile.ZipFile(fmu) as archive:
        return archive.namelist()
