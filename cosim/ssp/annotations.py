"""What SSP leaves open, in an annotation of type "cosim" of the root system: docs/ssp.md describes it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lxml import etree

from cosim.errors import CosimError
from cosim.model.face import Kind
from cosim.ssp.content import ours
from cosim.ssp.document import Element, Where, line
from cosim.ssp.namespaces import COSIM, SSD
from cosim.ssp.structure import Annotated, Told, ToldEvent

ROOT = f"{{{COSIM}}}System"
_KINDS: dict[str, Kind] = {"continuous": "continuous", "sampled": "sampled"}


def annotated(system: Element, file: str) -> Annotated:
    """What our annotation of the root system says; raises CosimError for what it cannot say."""
    found = [element for element in ours(system, SSD) if element.tag == ROOT]
    if not found:
        return Annotated()
    root = found[0]
    return Annotated(
        _time(root, "recordEvery", file, 0.0) or 0.0,
        tuple(child.get("pattern", "") for child in root.iterfind(f"{{{COSIM}}}Unrecorded")),
        tuple(_instances(root, file)),
        tuple(_events(root, file)),
    )


def _instances(root: Element, file: str) -> Iterator[Told]:
    for child in root.iterfind(f"{{{COSIM}}}Instance"):
        element, kind = _wanted(child, "element", file), child.get("kind")
        if kind is not None and kind not in _KINDS:
            raise CosimError(f"{Where(file, line(child))}: kind {kind!r} is neither continuous nor sampled")
        name, period = child.get("name", element), _time(child, "period", file, None)
        yield Told(element, name, period, _KINDS.get(kind or ""), Where(file, line(child)))


def _events(root: Element, file: str) -> Iterator[ToldEvent]:
    for child in root.iterfind(f"{{{COSIM}}}Event"):
        element, connector, value = (_wanted(child, name, file) for name in ("element", "connector", "value"))
        time = _time(child, "time", file, None)
        yield ToldEvent(0.0 if time is None else time, element, connector, value, Where(file, line(child)))


def _wanted(element: Element, name: str, file: str) -> str:
    value = element.get(name)
    if value is None:
        raise CosimError(f"{Where(file, line(element))}: the {etree.QName(element).localname} has no {name}; give one")
    return str(value)


def _time(element: Element, name: str, file: str, default: float | None) -> float | None:
    text = element.get(name)
    if text is None:
        return default
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise CosimError(f"{Where(file, line(element))}: {name} = {text!r} is no time in seconds")
    return value
