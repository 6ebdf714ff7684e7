"""Parameter bindings as data: sets of values (SSV, chapter 6) and mappings of their names (SSM, chapter 7)."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from lxml import etree

from cosim.errors import CosimError
from cosim.ssp.content import Content, suppressed
from cosim.ssp.document import Element, Where, checked, line, parsed
from cosim.ssp.namespaces import PARAMETER_MAPPING, PARAMETER_SET, SSD, SSM, SSV
from cosim.ssp.structure import Binding, Entry, Parameter

Fetch = Callable[[str, str, Where], tuple[bytes, str]]
"""The bytes of a source and what it is called, from its URI, the base of that ("SSD" or "component") and its place."""
_FORMATS = {
    f"{{{SSD}}}ParameterBinding": ("application/x-ssp-parameter-set", PARAMETER_SET, "a parameter set"),
    f"{{{SSD}}}ParameterMapping": ("application/x-ssp-parameter-mapping", PARAMETER_MAPPING, "a parameter mapping"),
}


def bindings(element: Element, file: str, fetch: Fetch) -> tuple[Binding, ...]:
    """The parameter bindings of a system or component that stands in the file called `file`."""
    found = element.iterfind(f"{{{SSD}}}ParameterBindings/{{{SSD}}}ParameterBinding")
    return tuple(_binding(binding, file, fetch) for binding in found)


def _binding(element: Element, file: str, fetch: Fetch) -> Binding:
    root, called = _content(element, element.find(f"{{{SSD}}}ParameterValues"), file, fetch)
    mapping = element.find(f"{{{SSD}}}ParameterMapping")
    entries = None if mapping is None else tuple(_entries(*_content(mapping, mapping, file, fetch)))
    return Binding(tuple(_parameters(root, called)), entries, element.get("prefix", ""))


def _content(element: Element, inline: Element | None, file: str, fetch: Fetch) -> tuple[Element, str]:
    """The set or mapping that a binding refers to or holds, and what its file is called."""
    where = Where(file, line(element))
    format_, expected, what = _FORMATS[str(element.tag)]
    if element.get("type", format_) != format_:
        raise CosimError(f"{where}: {what} of type {element.get('type')} cannot be read; give one of type {format_}")
    source = element.get("source")
    if source is not None:
        data, called = fetch(source, element.get("sourceBase", "SSD"), where)
        return parsed(data, called, expected), called
    inside = [] if inline is None else list(inline.iterchildren(etree.Element))
    if len(inside) != 1:
        raise CosimError(f"{where}: there must be a source, or {what} inside; give one of the two")
    return checked(inside[0], file, expected), file


def _parameters(root: Element, file: str) -> Iterator[Parameter]:
    content, seen = Content(root, SSV, file), set()
    for element in root.iterfind(f"{{{SSV}}}Parameters/{{{SSV}}}Parameter"):
        name, where, value = element.get("name", ""), content.where(element), next(iter(element))
        if name in seen:
            raise CosimError(f"{where}: the set has two values of {name!r}; keep one")
        seen.add(name)
        type_ = etree.QName(value).localname
        unit = content.unit(value) if type_ == "Real" else None
        yield Parameter(name, type_, value.get("value", ""), unit, where)


def _entries(root: Element, file: str) -> Iterator[Entry]:
    content, seen = Content(root, SSM, file), set()
    for element in root.iterfind(f"{{{SSM}}}MappingEntry"):
        target, where = element.get("target", ""), content.where(element)
        if target in seen:
            raise CosimError(f"{where}: the mapping has two entries with the target {target!r}; keep one")
        seen.add(target)
        yield Entry(element.get("source", ""), target, suppressed(element), content.change(element), where)
