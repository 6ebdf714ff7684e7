"""Broken documents and attributes of the whole: X1 to X12."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from lxml import etree

from broken.making import XML, Entry, Members, archive, description, renamed, text

text("X1", "declares a document type", "?>", '?><!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>')
text("X1", "line", "</ModelVariables>", "")
text("X2", "encoding ISO-8859-1", "UTF-8", "ISO-8859-1")
text("X3", "fmiVersion is '3.0'", 'fmiVersion="2.0"', 'fmiVersion="3.0"')
text("X4", "colour", 'modelName="Imu"', 'modelName="Imu" colour="red"')
text("X4", "valueReference", 'valueReference="0"', 'valueReference="zero"')
text("X7", "modelName is ' '", 'modelName="Imu"', 'modelName=" "')
text("X10", "canSerializeFMUstate without", 'canGetAndSetFMUstate="true"', 'canGetAndSetFMUstate="false"')
text("X11", "'logAll' is declared more than once", 'name="logStatusFatal"', 'name="logAll"')
text("X12", "stopTime is -1.0, which is not after startTime 0.0", 'stopTime="10.0"', 'stopTime="-1.0"')
text("X12", "stepSize is 0.0", 'stepSize="0.005"', 'stepSize="0.0"')
text("X12", "tolerance is nan", "<DefaultExperiment ", '<DefaultExperiment tolerance="NaN" ')


@description("X5", "model exchange only")
def _model_exchange(root: Any) -> None:
    element = root.find("CoSimulation")
    element.tag = "ModelExchange"
    for name in set(element.attrib) - {"modelIdentifier"}:
        del element.attrib[name]


@archive("X6", "modelIdentifier of CoSimulation is 'class-7'")
def _identifier(members: Members) -> Iterable[Entry]:
    members[XML] = members[XML].replace(b'modelIdentifier="Imu"', b'modelIdentifier="class-7"')
    return renamed(members, "binaries/linux64/Imu.so", "binaries/linux64/class-7.so")


@description("X47", "more than one Tool of the name 'ours'")
def _vendors(root: Any) -> None:
    annotations = etree.Element("VendorAnnotations")
    for _ in range(2):
        etree.SubElement(annotations, "Tool", name="ours")
    root.find("ModelVariables").addprevious(annotations)


@archive("X48", "SourceFiles of CoSimulation lists 'imu.c' more than once")
def _source_twice(members: Members) -> Iterable[Entry]:
    root = etree.fromstring(members[XML])
    files = etree.SubElement(root.find("CoSimulation"), "SourceFiles")
    for _ in range(2):
        etree.SubElement(files, "File", name="imu.c")
    return (members | {XML: etree.tostring(root), "sources/imu.c": b"int imu;"}).items()


@description("X8", "guid is ''")
def _guid(root: Any) -> None:
    root.set("guid", "")


@description("X9", "+00:00")
def _date(root: Any) -> None:
    root.set("generationDateAndTime", "2026-01-01T00:00:00+00:00")
