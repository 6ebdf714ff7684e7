"""What all files of SSP share (chapter 4 of the standard): units, enumerations, types and transformations."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Any

from lxml import etree

from cosim.errors import CosimError
from cosim.model.units import BASE, Conversion, Unit
from cosim.ssp.document import Element, Where, flag, line
from cosim.ssp.namespaces import SSC
from cosim.ssp.structure import Change, Connector, Items

_TYPES = ("Real", "Integer", "Boolean", "String", "Enumeration", "Binary")
_MAPS = {f"{kind}MappingTransformation": kind for kind in ("Boolean", "Integer", "Enumeration")}
_TRUE = {"true": "true", "1": "true", "false": "false", "0": "false"}


class Content:
    """The units and enumerations that the file called `file` defines; `namespace` is that of its root."""

    def __init__(self, root: Element, namespace: str, file: str) -> None:
        self.file = file
        self.units: dict[str, Unit] = self._named(root.iterfind(f"{{{namespace}}}Units/{{{SSC}}}Unit"), "unit", _unit)
        self.enumerations: dict[str, Items] = self._named(
            root.iterfind(f"{{{namespace}}}Enumerations/{{{SSC}}}Enumeration"), "enumeration", _items
        )

    def where(self, element: Element) -> Where:
        """The place of an element of this file."""
        return Where(self.file, line(element))

    def unit(self, element: Element) -> Unit | None:
        """The unit that a Real names; one that the file does not define is known by its name only."""
        name = element.get("unit")
        return None if name is None else self.units.get(name, Unit(name))

    def connector(self, element: Element, owner: str) -> Connector:
        """A connector, or an entry of a signal dictionary, of what is called `owner`; raises CosimError for Binary."""
        name, where = element.get("name", ""), self.where(element)
        said = next((child for child in element if _local(child) in _TYPES), None)
        type_ = None if said is None else _local(said)
        if type_ == "Binary":
            raise CosimError(f"{where}: {owner}.{name} is Binary, which FMI 2.0 has not; take the connector out")
        items: Items = ()
        if said is not None and type_ == "Enumeration":
            items = self.enumerations.get(said.get("name", ""), ())
        unit = self.unit(said) if said is not None and type_ == "Real" else None
        return Connector(name, element.get("kind", "inout"), type_, unit, items, where)

    def change(self, element: Element) -> Change | None:
        """The transformation that a connection or an entry of a mapping holds."""
        for child in element:
            name = _local(child)
            if name == "LinearTransformation":
                return Change("linear", self._linear(child))
            if name in _MAPS:
                return Change(_MAPS[name], entries=self._entries(child, _MAPS[name]))  # type: ignore[arg-type]
        return None

    def _linear(self, element: Element) -> Conversion:
        made = Conversion(*(float(element.get(key, default)) for key, default in (("factor", 1.0), ("offset", 0.0))))
        if not (math.isfinite(made.factor) and math.isfinite(made.offset)):
            raise CosimError(f"{self.where(element)}: factor and offset must be finite numbers")
        return made

    def _entries(self, element: Element, kind: str) -> tuple[tuple[str, str], ...]:
        pairs = [(entry.get("source", "").strip(), entry.get("target", "").strip()) for entry in element]
        if kind == "Boolean":
            pairs = [(_TRUE[source], _TRUE[target]) for source, target in pairs]
        known: dict[str, str] = {}
        for source, target in pairs:
            if known.setdefault(source, target) != target:
                raise CosimError(f"{self.where(element)}: the map has two entries for {source}; keep one")
        return tuple(known.items())

    def _named(self, elements: Iterable[Element], kind: str, make: Callable[[Element], Any]) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for element in elements:
            name = element.get("name", "")
            if name in found:
                raise CosimError(f"{self.where(element)}: two definitions of the {kind} {name!r}; keep one")
            found[name] = make(element)
        return found


def ours(element: Element, namespace: str) -> Iterable[Element]:
    """What the annotations of type "cosim" of the element contain."""
    for annotation in element.iterfind(f"{{{namespace}}}Annotations/{{{SSC}}}Annotation[@type='cosim']"):
        yield from annotation.iterchildren(etree.Element)


def suppressed(element: Element) -> bool:
    """Whether units are not to be converted."""
    return flag(element.get("suppressUnitConversion"))


def _local(element: Element) -> str:
    return etree.QName(element).localname if isinstance(element.tag, str) else ""


def _unit(element: Element) -> Unit:
    base = element.find(f"{{{SSC}}}BaseUnit")
    assert base is not None, "the schema wants one"
    exponents = tuple(int(base.get(symbol, 0)) for symbol in BASE)
    return Unit(element.get("name", ""), exponents, float(base.get("factor", 1.0)), float(base.get("offset", 0.0)))


def _items(element: Element) -> Items:
    return tuple((item.get("name", ""), int(item.get("value", 0))) for item in element.iterfind(f"{{{SSC}}}Item"))
