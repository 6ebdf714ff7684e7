"""What becomes of a value on its way: units are converted first, then the connection's own transformation (4.5.2).

A connector of a system without a unit has that of what it is connected to, one of an FMU that of its variable. With
suppressUnitConversion the transformation stands instead of all conversions of the connection.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from cosim.errors import CosimError
from cosim.model.face import Port, Value
from cosim.model.transformation import AS_IT_IS, Lookup, Transformation
from cosim.model.units import Unit, conversion
from cosim.ssp.bindings import Given
from cosim.ssp.document import Where, flag
from cosim.ssp.network import Edge
from cosim.ssp.structure import Change, Connector, Items


@dataclass(frozen=True, slots=True)
class Measured:
    """How a value is to be read at some place: its unit, and the items of its enumeration, where they are known."""

    unit: Unit | None = None
    items: Items = ()


def carried(way: Sequence[Edge], source: Measured, target: Measured) -> Transformation:
    """What becomes of a value along the connections; raises CosimError where units or maps do not fit."""
    made, unit, items = AS_IT_IS, source.unit, source.items
    for edge in way:
        where = f"{edge.joint.where}: {edge.text}"
        items = items or _items(edge.giving)
        taken = (edge is way[-1] and target.items) or _items(edge.taking) or items
        if edge.joint.suppressed:
            made = _changed(made, edge.joint.change, items, taken, where)
            unit = _unit(edge.taking)
        else:
            made, unit = _converted(made, unit, _unit(edge.giving), where)
            made, unit = _converted(made, unit, _unit(edge.taking), where)
            if edge is way[-1] and _unit(edge.taking) is None:
                made, unit = _converted(made, unit, target.unit, where, declared=False)
            made = _changed(made, edge.joint.change, items, taken, where)
        items = taken
    if not way[-1].joint.suppressed:
        made, _ = _converted(made, unit, target.unit, f"{way[-1].joint.where}: {way[-1].text}", declared=False)
    return made


def value_of(given: Given, target: Measured) -> tuple[Value, Measured]:
    """The value that a binding gives to what reads it as `target`, and how it is to be read.

    Raises CosimError for a value that cannot be made of it.
    """
    parameter, entry = given.parameter, given.entry
    value = _value(parameter.type, parameter.text, parameter.where)
    read = Measured(target.unit or parameter.unit, target.items)
    where = parameter.where if entry is None else entry.where
    step = AS_IT_IS
    if entry is None or not entry.suppressed:
        step, _ = _converted(step, parameter.unit, target.unit, str(where))
    change = None if entry is None else entry.change
    if change is not None and change.kind == "Enumeration" and isinstance(value, str):
        return dict(change.entries).get(value, value), read
    return _apply(_changed(step, change, target.items, target.items, str(where)), value, where), read


def arrived(value: Value, measured: Measured, way: Sequence[Edge], port: Port, target: Measured) -> Value:
    """What a value given to a connector of a system is at the variable `port` that it leads to."""
    if isinstance(value, str) and port.type != "String":
        changes = any(edge.joint.change for edge in way)
        if not changes:
            return value  # the name of an item
        known = dict(measured.items)
        if value not in known:
            raise CosimError(f"{way[0].joint.where}: {way[0].text}: the item {value!r} has no known value")
        value = known[value]
    return _apply(carried(way, measured, target), value, way[0].joint.where)


def _converted(
    made: Transformation, unit: Unit | None, target: Unit | None, where: str, *, declared: bool = True
) -> tuple[Transformation, Unit | None]:
    """With the conversion into the unit `target`, and the unit thereafter.

    A file of SSP does not say of a unit whether it is one of differences: what it has `declared` is one where the FMU
    says so.
    """
    if unit is None or target is None:
        return made, target or unit
    if declared:
        target = replace(target, relative=unit.relative)
    return made.then(conversion(unit, target, where)), unit if target.exponents is None else target


def _changed(made: Transformation, change: Change | None, here: Items, there: Items, where: str) -> Transformation:
    if change is None:
        return made
    if change.kind == "linear":
        return made.then(change.linear)
    if change.kind == "Enumeration":
        pairs = [(_item(source, here, where), _item(target, there, where)) for source, target in change.entries]
        return made.then(Lookup(tuple(pairs), partial=True))
    pairs = [(_whole(source), _whole(target)) for source, target in change.entries]
    return made.then(Lookup(tuple(pairs), partial=True))


def _item(name: str, items: Items, where: str) -> int:
    known = dict(items)
    if name not in known:
        raise CosimError(f"{where}: the map has the item {name!r}; known are {', '.join(known) or 'none'}")
    return known[name]


def _whole(text: str) -> int:
    return int({"true": "1", "false": "0"}.get(text, text))


def _unit(connector: Connector | None) -> Unit | None:
    return None if connector is None else connector.unit


def _items(connector: Connector | None) -> Items:
    return () if connector is None else connector.items


def _apply(step: Transformation, value: Value, where: Where) -> Value:
    if not step.steps:
        return value
    if isinstance(value, str):
        raise CosimError(f"{where}: the text {value!r} cannot be transformed")
    return step(float(value))


def _value(type_: str, text: str, where: Where) -> Value:
    """The text of a parameter as a value of its type."""
    if type_ == "Binary":
        raise CosimError(f"{where}: the value is Binary, which FMI 2.0 has not; take it out")
    if type_ == "Real":
        return float(text)
    if type_ == "Integer":
        return int(text)
    return flag(text) if type_ == "Boolean" else text
