"""Descriptions that lie, by name: how each is made from a good one. Something is wrong with all of them."""

from __future__ import annotations

import codecs
from collections.abc import Callable

Change = Callable[[bytes], bytes]


def text(old: str, new: str) -> Change:
    """Replace the first occurrence, which must be there."""

    def change(xml: bytes) -> bytes:
        assert old.encode() in xml, old
        return xml.replace(old.encode(), new.encode("utf-8", "surrogatepass"), 1)

    return change


def declared(subset: str, use: str = "&x;") -> Change:
    """A document type, and a use of what it declares."""
    return lambda xml: text("Imu", use)(text("?>", f"?><!DOCTYPE fmiModelDescription {subset}>")(xml))


def encoded(name: str, codec: str) -> Change:
    return lambda xml: xml.decode().replace("UTF-8", name, 1).encode(codec, "replace")


def variables(count: int, pattern: str) -> Change:
    """More variables: `pattern` with the number of each."""
    more = "".join(pattern.replace("NUMBER", str(number)) for number in range(count))
    return text("</ModelVariables>", f"{more}</ModelVariables>")


def inside(element: str, new: str) -> Change:
    return text(f"</{element}>", f"{new}</{element}>")


_REAL = '<ScalarVariable name="{0}" valueReference="{1}"><Real/></ScalarVariable>'
_LEVELS = "".join(f'<!ENTITY x{k} "{f"&x{k - 1};" * 10}">' for k in range(1, 10))
_NUMBERS = ("-1", "4294967296", "99999999999999999999999999", "NaN", "1e3", "0x10", " ", "\u0661")
DOCUMENTS: dict[str, Change] = {
    "laughter": declared(f'[<!ENTITY x0 "ha">{_LEVELS}]', "&x9;"),
    "quadratic blow-up": declared(f'[<!ENTITY x "{"a" * 50_000}">]', "&x;" * 5_000),
    "external entity": declared('[<!ENTITY x SYSTEM "file:///etc/passwd">]'),
    "remote entity": declared('[<!ENTITY x SYSTEM "http://127.0.0.1:9/x">]'),
    "parameter entity": declared('[<!ENTITY % x SYSTEM "file:///etc/passwd"> %x;]', "Imu"),
    "entity of itself": declared('[<!ENTITY x "&x;">]'),
    "remote document type": declared('SYSTEM "http://127.0.0.1:9/x.dtd"', "Imu"),
    "default attributes": declared('[<!ATTLIST fmiModelDescription evil CDATA "yes">]', "Imu"),
    "undeclared entity": text("Imu", "&nobody;"),
    "character zero": text("Imu", "&#0;"),
    "character beyond all": text("Imu", "&#x110000;"),
    "included file": text(
        "<ModelVariables>",
        '<x:include xmlns:x="http://www.w3.org/2001/XInclude" href="/etc/passwd" parse="text"/><ModelVariables>',
    ),
    "remote schema": text("<fmiModelDescription", '<fmiModelDescription xmlns="http://127.0.0.1:9/fmi"'),
    "style sheet and no root": lambda xml: b'<?xml version="1.0"?><?xml-stylesheet href="file:///etc/passwd"?>',
    "UTF-16": encoded("UTF-16", "utf-16"),
    "UTF-16 without a mark": encoded("UTF-16", "utf-16-be"),
    "UTF-32": encoded("UTF-32", "utf-32"),
    "UTF-7": encoded("UTF-7", "utf-7"),
    "EBCDIC": encoded("cp037", "cp037"),
    "Latin 1": encoded("ISO-8859-1", "latin-1"),
    "an encoding nobody knows": encoded("X-NOBODY", "utf-8"),
    "a mark of another encoding": lambda xml: codecs.BOM_UTF16_LE + xml,
    "bytes that are no UTF-8": lambda xml: xml.replace(b'modelName="Imu"', b'modelName="\xc3\x28\xa0\xa1"'),
    "surrogates": lambda xml: xml.replace(b'modelName="Imu"', b'modelName="\xed\xa0\x80"'),
    "a zero byte": lambda xml: xml.replace(b"Imu", b"I\0u", 1),
    "control characters": lambda xml: xml.replace(b"Imu", b"\x1b[2J\x07", 1),
    "version 1.1": text('version="1.0"', 'version="9.9"'),
    "nothing": lambda xml: b"",
    "blanks": lambda xml: b" \n" * 1_000,
    "noise": lambda xml: bytes(range(256)) * 100,
    "two roots": lambda xml: xml + b"<second/>",
    "text after the root": lambda xml: xml + b"and so on",
    "no end": lambda xml: xml[: len(xml) // 2],
    "no end of a tag": lambda xml: xml[:-2],
    "a comment without end": text("<ModelVariables>", "<!-- <ModelVariables>"),
    "an attribute twice": text("<CoSimulation ", '<CoSimulation modelIdentifier="Imu" modelIdentifier="Imu" '),
    "another root": lambda xml: b"<html><body/></html>",
    "depth of 100 000": inside("ModelVariables", "<a>" * 100_000),
    "depth of 200, closed": inside("ModelVariables", "<a>" * 200 + "</a>" * 200),
    "100 000 attributes": text("<CoSimulation ", "<CoSimulation " + "".join(f'a{k}="" ' for k in range(100_000))),
    "an attribute of 12 MB": text('modelName="Imu"', f'modelName="Imu" description="{"x" * 12_000_000}" odd=""'),
    "a name of 1 MB": variables(1, _REAL.format("n" * 1_000_000, "-1")),
    "30 000 variables of one name": variables(30_000, _REAL.format("twin", "0")),
    "20 000 names twice": inside(
        "ModelVariables", "".join(_REAL.format(f"n{k // 2}", 90_000 + k) for k in range(40_000))
    ),
    "100 000 log categories": inside("LogCategories", '<Category name="one"/>' * 100_000),
    "100 000 outputs": inside("Outputs", '<Unknown index="1"/>' * 100_000),
    "100 000 dependencies": text('<Unknown index="', f'<Unknown dependencies="{"7 " * 100_000}" index="'),
    "indices without end": inside("Outputs", f'<Unknown index="{"9" * 5_000}"/>'),
    "100 000 items": text(
        "<LogCategories>",
        '<TypeDefinitions><SimpleType name="E"><Enumeration>'
        + '<Item name="i" value="1"/>' * 100_000
        + "</Enumeration></SimpleType></TypeDefinitions><LogCategories>",
    ),
    "a unit in brackets without end": text(' unit="', f' unit="{"(" * 50_000}" displayUnit="'),
    "a unit of many factors": text(' unit="', f' unit="{"m." * 50_000}" displayUnit="'),
    "an exponent without end": text(' unit="', ' unit="m99999999999999" displayUnit="'),
    "a name that a grammar may choke on": variables(1, _REAL.format("der(" * 5_000 + "a.b[1,2]'\\''" * 5_000, "70000")),
    "an identifier that leads out": text('modelIdentifier="Imu"', 'modelIdentifier="../../Imu"'),
    "an identifier of blanks": text('modelIdentifier="Imu"', 'modelIdentifier="   "'),
    "no identifier": text('modelIdentifier="Imu"', ""),
    "an identifier of 100 000 letters": text('modelIdentifier="Imu"', f'modelIdentifier="{"I" * 100_000}"'),
    "a date that never was": text('generationDateAndTime="', 'generationDateAndTime="2024-13-45T99:99:99Z" author="'),
    "an experiment without end": text('stopTime="10.0"', 'stopTime="INF"'),
    "an experiment backwards": text('stopTime="10.0"', 'stopTime="-1e308"'),
    "a step of nothing": text('stepSize="0.005"', 'stepSize="1e-400"'),
    "a source that leads out": text("<LogCategories>", "<SourceFiles/><LogCategories>"),
    **{f"reference {number!r}": text('valueReference="0"', f'valueReference="{number}"') for number in _NUMBERS},
}  # fmt: skip
