"""XML files of SSP: parsed without entities, held against the schemas of SSP 1.0, mistakes with file and line.

Files of SSP 2.0 that hold nothing but what 1.0 has too are read as such; `lowered` says what is.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import fmpy
from lxml import etree

from cosim.errors import CosimError
from cosim.ssp.lowering import lowered
from cosim.ssp.namespaces import PREFIXES, SCHEMAS
from fmukit.unpacking import ArchiveError, refuse_entities

Element = Any
"""An element of lxml, which has no types."""
_NAMED = ("Parameter", "Connector", "Component", "SignalDictionaryReference", "SignalDictionary", "System")
_REMEDIES = {
    "The attribute 'source' is required but missing": "give the component the URI of its FMU",
    "The attribute 'kind' is required but missing": "give the connector the causality of its variable",
    "This element is not expected": "take it out, or put it where the schema has it",
}
_REMEDY = "correct it there, or let the tool that wrote the file write SSP 1.0"


@dataclass(frozen=True, slots=True)
class Where:
    """A place in a file."""

    file: str
    line: int

    def __str__(self) -> str:
        return f"{self.file}, line {self.line}"


def parsed(data: bytes, file: str, expected: str) -> Element:
    """The root of the XML file called `file`, an `expected` element that keeps its schema; raises CosimError."""
    try:
        refuse_entities(file, data)
        root = etree.fromstring(data, etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False))
    except ArchiveError as error:
        raise CosimError(str(error)) from None
    except etree.XMLSyntaxError as error:
        raise CosimError(f"{file}, line {error.lineno or 1}: this is no XML: {error.msg}") from None
    return checked(root, file, expected)


def checked(root: Element, file: str, expected: str) -> Element:
    """`root`, of SSP 1.0; raises CosimError with the line where it is not as the schema wants."""
    if root.tag != expected:
        raise CosimError(f"{Where(file, line(root))}: this is no {_local(expected)} of SSP but the element {root.tag}")
    version = root.get("version", "")
    if version.startswith("2."):
        lowered(root)
    elif not version.startswith("1."):
        raise CosimError(f"{Where(file, line(root))}: version {version!r} of SSP cannot be read; 1.0 and 2.0 can")
    schema = _schema(expected)
    if not schema.validate(root):
        raise CosimError(_mistake(root, file, schema.error_log[0]))
    return root


def line(element: Element) -> int:
    """The line of an element."""
    return int(element.sourceline or 0)


def flag(text: str | None) -> bool:
    """The value of an attribute of type xs:boolean; false where there is none."""
    return text is not None and text.strip() in ("true", "1")


@cache
def _schema(expected: str) -> Any:
    return etree.XMLSchema(etree.parse(Path(fmpy.__file__).parent / "ssp" / "schema" / SCHEMAS[expected]))


def _mistake(root: Element, file: str, entry: Any) -> str:
    """The first thing the schema has to say, in one sentence."""
    said = " ".join(entry.message.split()).rstrip(".")
    for prefix, namespace in PREFIXES.items():
        said = said.replace(f"{{{namespace}}}", f"{prefix}:")
    owner = _owner(root, entry)
    remedy = next((remedy for start, remedy in _REMEDIES.items() if start in said), _REMEDY)
    said = re.sub(r"^Element '([^']*)'(, attribute '[^']*')?: ", r"\1\2: ", said)
    said = re.sub(r"(?<=[:.] )[A-Z](?=[a-z]+ )", lambda found: found[0].lower(), said).replace(". ", "; ")
    said = said.replace("( ", "(").replace(" )", ")")
    return f"{Where(file, entry.line)}{owner}: {said}; {remedy}"


def _owner(root: Element, entry: etree._LogEntry) -> str:
    """The innermost component, connector or parameter that the mistake is in."""
    known = {prefix: uri for each in root.iter(etree.Element) for prefix, uri in each.nsmap.items() if prefix}
    below = "/".join([".", *(entry.path or "").split("/")[2:]])  # the path begins with the root that was checked
    found = root.xpath(below, namespaces=known)
    element = found[0] if found else None
    while element is not None:
        if _local(element.tag) in _NAMED and element.get("name"):
            kind = re.sub(r"(?<!^)([A-Z])", r" \1", _local(element.tag)).lower()
            return f", {kind} {element.get('name')!r}"
        element = element.getparent()
    return ""


def _local(tag: str) -> str:
    return etree.QName(tag).localname
