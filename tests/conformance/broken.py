"""One good FMU and how to break it so that a single rule fails: `BROKEN` has (rule, words of its sentence, how)."""

from __future__ import annotations

import stat
import warnings
import zipfile
from collections.abc import Callable, Iterable, Iterator
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


# the archive


@archive("A1", "does not match its checksum")
def _flipped(members: Members) -> Iterable[Entry]:
    """Stored as it is, so that a test can flip a letter of it."""
    yield from members.items()
    yield zipfile.ZipInfo("resources/flipped.txt"), b"FLIPPED"


for _method in (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):

    @archive("A2", f"is packed with method {_method}")
    def _packed(members: Members, method: int = _method) -> Iterator[Entry]:
        yield from members.items()
        item = zipfile.ZipInfo("resources/packed.txt")
        item.compress_type = method
        yield item, b"x" * 100


for _name in ("../escape.txt", "/etc/escape.txt", "C:/escape.txt", "resources\\escape.txt", "resources/../../escape"):

    @archive("A3", repr(_name))
    def _escape(members: Members, name: str = _name) -> Iterator[Entry]:
        yield from members.items()
        yield name, b"x"


@archive("A4", "is a symbolic link or device")
def _link(members: Members) -> Iterator[Entry]:
    yield from members.items()
    item = zipfile.ZipInfo("resources/link")
    item.create_system, item.external_attr = 3, (stat.S_IFLNK | 0o777) << 16
    yield item, b"/etc/passwd"


@archive("A5", "2 entries of the name 'resources/twice.txt'")
def _twice(members: Members) -> Iterator[Entry]:
    yield from members.items()
    yield from (("resources/twice.txt", b"1"), ("resources/twice.txt", b"2"))


@archive("A5", "2 entries of the name 'resources/slavemodule.txt'")
def _capitals(members: Members) -> Iterator[Entry]:
    yield from members.items()
    yield "resources/SlaveModule.txt", b"other"


@archive("A5", "2 entries of the name 'resources/slavemodule.txt'")
def _slashes(members: Members) -> Iterator[Entry]:
    yield from members.items()
    yield "resources//slavemodule.txt", b"other"


@archive("A6", "33554432 bytes packed into")
def _bomb(members: Members) -> Iterator[Entry]:
    yield from members.items()
    yield "resources/zeros.bin", bytes(32 << 20)


@archive("A6", "at most 20000 are accepted")
def _crowd(members: Members) -> Iterator[Entry]:
    yield from members.items()
    yield from ((f"resources/{i}", b"") for i in range(20_001))


@archive("A7", "there is no modelDescription.xml, but 'ModelDescription.xml'")
def _misspelt(members: Members) -> Iterable[Entry]:
    return (members | {"ModelDescription.xml": members.pop(XML)}).items()


def renamed(members: Members, old: str, new: str) -> Iterable[Entry]:
    assert any(old in name for name in members)
    return [(name.replace(old, new), data) for name, data in members.items()]


@archive("A8", "there is binaries/linux_x64")
def _platform(members: Members) -> Iterable[Entry]:
    return renamed(members, "binaries/linux64", "binaries/linux_x64")


@archive("A9", "there is no binaries/linux64/Imu.so; the folder has Sensor.so")
def _library(members: Members) -> Iterable[Entry]:
    return renamed(members, "binaries/linux64/Imu.so", "binaries/linux64/Sensor.so")


@archive("A10", "binaries/win64/Imu.dll is not a win64 library")
def _elf_for_windows(members: Members) -> Iterable[Entry]:
    return (members | {"binaries/win64/Imu.dll": members["binaries/linux64/Imu.so"]}).items()


@archive("A11", "'notes.txt' at the root")
def _litter(members: Members) -> Iterable[Entry]:
    return (members | {"notes.txt": b"mine"}).items()


@archive("A12", "no index.html")
def _no_index(members: Members) -> Iterable[Entry]:
    return [(name, data) for name, data in members.items() if name != "documentation/index.html"]


@description("A13", "'imu.c', which is not in sources/")
def _sources(root: Any) -> None:
    files = etree.SubElement(root.find("CoSimulation"), "SourceFiles")
    etree.SubElement(files, "File", name="imu.c")


@archive("A14", "names the script 'other'")
def _script(members: Members) -> Iterable[Entry]:
    return (members | {"resources/slavemodule.txt": b"other"}).items()


# the document

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


@description("X8", "guid is ''")
def _guid(root: Any) -> None:
    root.set("guid", "")


@description("X9", "+00:00")
def _date(root: Any) -> None:
    root.set("generationDateAndTime", "2026-01-01T00:00:00+00:00")


# units


@description("X13", "'m' is defined more than once")
def _two_units(root: Any) -> None:
    root.find("UnitDefinitions").append(etree.fromstring('<Unit name="m"><BaseUnit m="1"/></Unit>'))


@description("X14", "'m': factor of BaseUnit is 0.0")
def _zero_factor(root: Any) -> None:
    unit(root, "m")[0].set("factor", "0")


@description("X15", "'m/s2' has the exponent -1 of s where its name means -2")
def _exponent(root: Any) -> None:
    unit(root, "m/s2")[0].set("s", "-1")


@description("X15", "has the factor 3.14")
def _factor(root: Any) -> None:
    unit(root, "s")[0].set("factor", "3.14")


@description("X16", "display unit 'm' of unit 'rad/s': the two do not measure the same quantity")
def _other_quantity(root: Any) -> None:
    etree.SubElement(unit(root, "rad/s"), "DisplayUnit", name="m")


@description("X16", "the factor 0.0174533 where its name means 57.29")
def _inverse(root: Any) -> None:
    etree.SubElement(unit(root, "rad/s"), "DisplayUnit", name="deg/s", factor="0.0174532925")


@description("X17", "has the unit 'furlong'")
def _furlong(root: Any) -> None:
    variable(root, "parameter")[0].set("unit", "furlong")


@description("X18", "has no display unit 'km'")
def _display(root: Any) -> None:
    variable(root, "parameter")[0].set("displayUnit", "km")


# types


@description("X19", "'Angle' is defined more than once")
def _two_types(root: Any) -> None:
    add_types(root, *['<SimpleType name="Angle"><Real/></SimpleType>'] * 2)


@description("X20", "declaredType 'Angle', which is not defined")
def _undefined(root: Any) -> None:
    variable(root, "parameter")[0].set("declaredType", "Angle")


@description("X20", "its declaredType 'Count' is Integer")
def _wrong_type(root: Any) -> None:
    add_types(root, '<SimpleType name="Count"><Integer/></SimpleType>')
    variable(root, "parameter")[0].set("declaredType", "Count")


MODES = '<SimpleType name="Mode"><Enumeration><Item name="a" value="1"/><Item name="b" value="{}"/></Enumeration>'


@description("X21", "enumeration Mode has two items of the value '1'")
def _items(root: Any) -> None:
    add_types(root, MODES.format(1) + "</SimpleType>")


# variables

DISCRETE = {"causality": "local", "variability": "discrete"}


@description("X22", "2 variables have the name 'fault'")
def _two_names(root: Any) -> None:
    add_variable(root, "fault", DISCRETE)


@description("X23", "'3rd wheel' is no structured name")
def _name(root: Any) -> None:
    variable(root, "parameter").set("name", "3rd wheel")


@description("X24", "the Boolean variable fault is continuous by default")
def _by_default(root: Any) -> None:
    del variable(root, "output", "Boolean").attrib["variability"]


@description("X25", "causality parameter with variability continuous")
def _moving_parameter(root: Any) -> None:
    variable(root, "parameter").set("variability", "continuous")


@description("X26", "has initial exact, which a discrete input must not have")
def _initial(root: Any) -> None:
    variable(root, "input").set("initial", "exact")


@description("X27", "time, clock are all independent")
def _two_times(root: Any) -> None:
    for name in ("time", "clock"):
        add_variable(root, name, {"causality": "independent"})


@description("X28", "can all be set")
def _alias(root: Any) -> None:
    variable(root, "input", nth=1).set("valueReference", variable(root, "input").get("valueReference"))


@description("X28", "have the units m, rad/s")
def _alias_units(root: Any) -> None:
    add_variable(root, "alias", DISCRETE, unit="m")
    output = next(
        v for v in root.iter("ScalarVariable") if v.get("causality") == "output" and v[0].get("unit") == "rad/s"
    )
    root.find("ModelVariables")[-1].set("valueReference", output.get("valueReference"))


@description("X29", "which is no other variable")
def _derivative(root: Any) -> None:
    add_variable(root, "rate", {"causality": "local"}, derivative="99999")


# values


@description("X30", "(initial exact) has no start value")
def _no_start(root: Any) -> None:
    del variable(root, "parameter")[0].attrib["start"]


@description("X31", "is calculated and has the start value 1.0")
def _start(root: Any) -> None:
    variable(root, "output")[0].set("start", "1.0")


@description("X32", "has the start value nan")
def _nan(root: Any) -> None:
    variable(root, "parameter")[0].set("start", "NaN")


@description("X33", "variable count starts at 0, outside [1, 2]")
def _outside(root: Any) -> None:
    add_variable(root, "count", DISCRETE | {"initial": "exact"}, "Integer", start="0", min="1", max="2")


@description("X34", "starts at 0, which is none of [1, 2]")
def _no_item(root: Any) -> None:
    add_types(root, MODES.format(2) + "</SimpleType>")
    kind = {"causality": "parameter", "variability": "fixed"}
    add_variable(root, "mode", kind, "Enumeration", declaredType="Mode", start="0")


@description("X35", "has min 2.0 and max 1.0")
def _order(root: Any) -> None:
    variable(root, "output")[0].attrib.update({"min": "2", "max": "1"})


@description("X36", "has the nominal value -5.0")
def _nominal(root: Any) -> None:
    variable(root, "output")[0].set("nominal", "-5")


# structure


@description("X37", "Outputs lists the index")
def _listed_twice(root: Any) -> None:
    etree.SubElement(unknowns(root, "Outputs"), "Unknown", dict(unknowns(root, "Outputs")[0].attrib))


@description("X37", "InitialUnknowns lists the index 99999, but there are")
def _no_variable(root: Any) -> None:
    etree.SubElement(unknowns(root, "InitialUnknowns"), "Unknown", index="99999")


@description("X38", "Outputs lacks")
def _lacking(root: Any) -> None:
    del unknowns(root, "Outputs")[0]


@description("X38", "but it is no output")
def _no_output(root: Any) -> None:
    etree.SubElement(unknowns(root, "Outputs"), "Unknown", index="1")


@description("X39", "which has no attribute derivative")
def _no_derivative(root: Any) -> None:
    derivatives = etree.Element("Derivatives")
    etree.SubElement(derivatives, "Unknown", index=unknowns(root, "Outputs")[0].get("index"))
    unknowns(root, "Outputs").addnext(derivatives)


@description("X40", "it is unknown at the start")
def _not_unknown(root: Any) -> None:
    del unknowns(root, "InitialUnknowns")[0]


@description("X41", "follows")
def _order_of_unknowns(root: Any) -> None:
    listed = unknowns(root, "InitialUnknowns")
    listed.append(listed[0])


@description("X42", "depends on the index 99999")
def _no_dependency(root: Any) -> None:
    unknowns(root, "Outputs")[0].set("dependencies", "99999")


@description("X42", "not each once in order")
def _dependency_order(root: Any) -> None:
    indices = [str(i) for i, v in enumerate(root.iter("ScalarVariable"), start=1) if v.get("causality") == "input"]
    unknowns(root, "Outputs")[0].set("dependencies", " ".join(reversed(indices)))


@description("X43", "a fixed parameter")
def _known_parameter(root: Any) -> None:
    unknowns(root, "Outputs")[0].set("dependencies", "1")


@description("X44", "whose initial is calculated")
def _circular(root: Any) -> None:
    unknowns(root, "InitialUnknowns")[0].set("dependencies", unknowns(root, "InitialUnknowns")[1].get("index"))


@description("X45", "0 dependencies and 1 kinds")
def _kinds(root: Any) -> None:
    unknowns(root, "Outputs")[0].set("dependenciesKind", "dependent")
