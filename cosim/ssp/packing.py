"""FMUs as they travel in an exported system: with the tables that String parameters of their instances name.

Not every tool sets Strings. So a table becomes part of the FMU, whose parameter then starts with the name of it: an FMU
of its own, with a name of its own for its package of Python code, since a process holds one package of a name.
"""

from __future__ import annotations

import io
import json
import logging
import re
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from lxml import etree

from cosim.model.node import Node
from fmukit.packing import pack

_PACKAGE = re.compile(r"resources/fmu_(\w+)/interface\.json")
_DESCRIPTION = "modelDescription.xml"
_LOG = logging.getLogger("cosim")


@dataclass(frozen=True, slots=True)
class Table:
    """The file `name` with its `content`, which the String parameter `parameter` names."""

    parameter: str
    name: str
    content: bytes


@dataclass(frozen=True, slots=True)
class Model:
    """A model's file, the name it has in resources/, and the table that goes into it."""

    file: Path
    name: str
    table: Table | None = None


def table_of(node: Node, file: Path) -> Table | None:
    """The table that the node's FMU, at `file`, brings along; its parameter is set no more.

    Of an FMU that would not look inside itself nothing is packed: the path stays, and is told.
    """
    named = [name for name, value in node.values.items() if _is_path(node, name, value)]
    found = None
    for name in named:
        path = Path(str(node.values[name]))
        if name == _reads(file):
            found = Table(name, path.name, path.read_bytes())
            del node.values[name]
        else:
            _LOG.warning("%s.%s stays the path %s, as %s cannot bring it along", node.name, name, path, file.name)
    return found


def packed(model: Model) -> bytes:
    """The FMU as it is, or made to start with its table."""
    data = model.file.read_bytes()
    if model.table is None:
        return data
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {name: archive.read(name) for name in archive.namelist() if not name.endswith("/")}
    return pack(_starting_with(model.table, members))


def _starting_with(table: Table, members: Mapping[str, bytes]) -> dict[str, bytes]:
    """The members of an FMU whose `table.parameter` starts with the name of a table inside."""
    interface, old = _interface(members)
    digest = sha256(
        b"\0".join([old.encode(), table.parameter.encode(), table.name.encode(), table.content])
    ).hexdigest()
    new = digest[: len(old)]
    name = _free(f"resources/{table.name}", members)
    changed = {
        interface: _with_start(members[interface], table.parameter, Path(name).name),
        _DESCRIPTION: _described(members[_DESCRIPTION], table.parameter, Path(name).name, digest),
    }
    renamed = {each.replace(old, new): _renamed(each, data, old, new) for each, data in {**members, **changed}.items()}
    return renamed | {name: table.content}


def _renamed(name: str, data: bytes, old: str, new: str) -> bytes:
    """What names the package: the script and the file that names the script."""
    beside = name.count("/") == 1 and name.startswith("resources/")
    return data.replace(old.encode(), new.encode()) if beside else data


def _with_start(data: bytes, parameter: str, start: str) -> bytes:
    described = json.loads(data)
    for variable in described["variables"]:
        if variable["name"] == parameter:
            variable["start"] = start
    return json.dumps(described).encode()


def _described(data: bytes, parameter: str, start: str, digest: str) -> bytes:
    root = etree.fromstring(data)
    parts = (digest[:8], digest[8:12], digest[12:16], digest[16:20], digest[20:32])
    root.set("guid", f"{{{'-'.join(parts)}}}")
    for variable in root.iterfind("ModelVariables/ScalarVariable"):
        if variable.get("name") == parameter:
            variable[0].set("start", start)
    return bytes(etree.tostring(root, encoding="UTF-8", xml_declaration=True))


def _reads(fmu: Path) -> str | None:
    """The parameter that names a table, of an FMU that looks for one inside itself."""
    with zipfile.ZipFile(fmu) as archive:
        members = archive.namelist()
        found = next((name for name in members if _PACKAGE.fullmatch(name)), None)
        if found is None or found.replace("interface.json", "runtime/table.py") not in members:
            return None
        table = json.loads(archive.read(found)).get("table")
    return table["parameter"] if table else None


def _interface(members: Mapping[str, bytes]) -> tuple[str, str]:
    """The member that describes the interface, and the hash in the name of its package."""
    return next((name, found[1]) for name in members if (found := _PACKAGE.fullmatch(name)))


def _is_path(node: Node, name: str, value: object) -> bool:
    return node.face.ports[name].type == "String" and bool(value) and Path(str(value)).is_file()


def _free(name: str, members: Mapping[str, bytes]) -> str:
    """The name, numbered where a member has it."""
    path, number = Path(name), 1
    while name in members:
        number += 1
        name = path.with_name(f"{path.stem}-{number}{path.suffix}").as_posix()
    return name
