"""SSP 2.0 read as SSP 1.0, as far as it says the same: the rest is left, and the schema of 1.0 refuses it by name.

Float64 is Real and Int32 is Integer (SSP 2.0, 4.5.1); meta data, signatures and units for display mean nothing to a
run. Arrays, clocks, other types and further kinds of connectors stay, as FMI 2.0 has no counterpart.
"""

from __future__ import annotations

from lxml import etree

_TYPES = {"Float64": "Real", "Int32": "Integer"}
_WITHOUT_MEANING = ("MetaData", "Signature", "DisplayUnit")
_GEOMETRY = ("systemInnerX", "systemInnerY")


def lowered(root: etree._Element) -> None:
    """Turn the elements of SSP 2.0 in `root` into those of 1.0, where there are any."""
    for element in list(root.iter(etree.Element)):
        name = etree.QName(element)
        if name.localname in _WITHOUT_MEANING and element is not root:
            element.getparent().remove(element)
            continue
        if name.localname in _TYPES:
            element.tag = f"{{{name.namespace}}}{_TYPES[name.localname]}"
        if element.get("version", "").startswith("2."):
            element.set("version", "1.0")
        for attribute in _GEOMETRY:
            element.attrib.pop(attribute, None)
