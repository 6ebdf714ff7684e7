"""How a good FMU is broken so that a single rule fails: decorators that add to `BROKEN`, and what they change."""

from __future__ import annotations

import warnings
import zipfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lxml import etree

XML = "modelDescription.xml"
Members = dict[str, bytes]
Entry = tuple[zipfile.ZipInfo | str, bytes]


@dataclass(frozen=True)
class Broken:
    """`break_` turns the entries of a good FMU into those of one that violates `rule`; the finding says `says`."""

    rule: str
    says: str
    break_: Callable[[Members], Iterable[Entry]]

    def make(self, good: Path, target: Path) -> Path:
        with zipfile.ZipFile(good) as source:
            members = {name: source.read(name) for name in source.namelist()}
        with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as sink, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # zipfile warns of duplicate names
            for name, data in self.break_(members):
                sink.writestr(name, data)
        return target


BROKEN: list[Broken] = []


def archive(rule: str, says: str) -> Callable[[Callable[[Members], Iterable[Entry]]], Any]:
    """The decorated function gives the entries of the broken archive."""
    return lambda break_: BROKEN.append(Broken(rule, says, break_)) or break_


def text(rule: str, says: str, old: str, new: str) -> None:
    """Replace the first `old` of the description."""

    def break_(members: Members) -> Iterable[Entry]:
        assert old.encode() in members[XML]
        return (members | {XML: members[XML].replace(old.encode(), new.encode(), 1)}).items()

    BROKEN.append(Broken(rule, says, break_))


def description(rule: str, says: str) -> Callable[[Callable[[Any], None]], Any]:
    """The decorated function changes the root element of the description."""

    def register(change: Callable[[Any], None]) -> Callable[[Any], None]:
        def break_(members: Members) -> Iterable[Entry]:
            root = etree.fromstring(members[XML])
            change(root)
            return (members | {XML: etree.tostring(root, xml_declaration=True, encoding="UTF-8")}).items()

        BROKEN.append(Broken(rule, says, break_))
        return change

    return register


def variable(root: Any, causality: str, type_: str = "Real", nth: int = 0) -> Any:
    found = root.xpath(f"ModelVariables/ScalarVariable[@causality='{causality}'][{type_}]")
    return found[nth]


def add_variable(root: Any, name: str, kind: Any = (), type_: str = "Real", **attributes: str) -> None:
    """Append a variable, so that no index changes."""
    variables = root.find("ModelVariables")
    vr = str(10_000 + len(variables))
    etree.SubElement(etree.SubElement(variables, "ScalarVariable", {"name": name, "valueReference": vr, **dict(kind)}),
                     type_, attributes)  # fmt: skip


def add_types(root: Any, *types: str) -> None:
    definitions = etree.fromstring(f"<TypeDefinitions>{''.join(types)}</TypeDefinitions>")
    root.find("UnitDefinitions").addnext(definitions)


def unit(root: Any, name: str) -> Any:
    return root.find(f"UnitDefinitions/Unit[@name='{name}']")


def unknowns(root: Any, place: str) -> Any:
    return root.find(f"ModelStructure/{place}")


def renamed(members: Members, old: str, new: str) -> Iterable[Entry]:
    assert any(old in name for name in members)
    return [(name.replace(old, new), data) for name, data in members.items()]
