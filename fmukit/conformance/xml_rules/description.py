"""The description as a document, and what it says of the FMU as a whole."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from datetime import UTC, datetime

from fmukit.conformance.package import DESCRIPTION, Package
from fmukit.conformance.rule import ADVICE, NotApplicable, Rules
from fmukit.conformance.xml_rules.group import reliable, repeated

DOCUMENT: Rules[Package] = Rules()
RULES: Rules[Package] = Rules(reliable)
_ENCODING = re.compile(rb"""<\?xml[^>]*encoding\s*=\s*["']([^"']*)["']""")
_DATE = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ")
_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_KEYWORDS = re.compile(
    "auto|break|case|char|const|continue|default|do|double|else|enum|extern|float|for|goto|if|inline|int|long|register|"
    "restrict|return|short|signed|sizeof|static|struct|switch|typedef|union|unsigned|void|volatile|while"
)


@DOCUMENT.add(
    "X1",
    f"{DESCRIPTION} is XML without document type or entities",
    "2.2",
    "Correct the place named; take out <!DOCTYPE> and <!ENTITY>, which can read other files or exhaust the memory.",
)
def _well_formed(package: Package) -> Iterator[str]:
    if package.damage or DESCRIPTION not in package.names:
        raise NotApplicable(f"there is no {DESCRIPTION} that can be read")
    if package.flaw:
        yield package.flaw


@DOCUMENT.add(
    "X2", "The description is encoded in UTF-8", "2.2", 'Save the file as UTF-8 and say so: encoding="UTF-8".'
)
def _encoding(package: Package) -> Iterator[str]:
    if package.root is None:
        raise NotApplicable("there is no description")
    declared = _ENCODING.match(package.xml.removeprefix(b"\xef\xbb\xbf"))
    if declared and declared[1].upper() != b"UTF-8":
        yield f"the first line declares the encoding {declared[1].decode('ascii', 'replace')}"


@DOCUMENT.add(
    "X3", "The FMU is for FMI 2.0", "2.2.1", 'Export for FMI 2.0 (fmiVersion="2.0"); other versions are not checked.'
)
def _version(package: Package) -> Iterator[str]:
    if package.root is None:
        raise NotApplicable("there is no description")
    if package.root.tag != "fmiModelDescription":
        yield f"the document is a <{package.root.tag}>, not a <fmiModelDescription>"
    elif package.root.get("fmiVersion") != "2.0":
        yield f"fmiVersion is {package.root.get('fmiVersion')!r}"


@DOCUMENT.add(
    "X4",
    "The description follows the XML schema of FMI 2.0",
    "2.2",
    "Correct the element or attribute at the line named; the schema is fmi2ModelDescription.xsd of the standard.",
)
def _schema(package: Package) -> Iterator[str]:
    if package.root is None or package.root.get("fmiVersion") != "2.0":
        raise NotApplicable("there is no description of FMI 2.0")
    yield from package.schema_errors


@RULES.add(
    "X5",
    "The FMU offers co-simulation",
    ADVICE,
    "Export the FMU for co-simulation: add the element CoSimulation. Other FMUs are not run here.",
    vital=True,
)
def _cosimulation(package: Package) -> Iterator[str]:
    if package.cosimulation is None:
        yield "there is no element CoSimulation: the FMU is for model exchange only"


@RULES.add(
    "X6",
    "modelIdentifier is a C name",
    "4.3.1",
    "Use letters, digits and _ only, not starting with a digit and no keyword of C; rename the library alike.",
)
def _identifier(package: Package) -> Iterator[str]:
    for element in package.root.iterfind("*[@modelIdentifier]"):
        name = element.get("modelIdentifier")
        if not _IDENTIFIER.fullmatch(name) or _KEYWORDS.fullmatch(name):
            yield f"modelIdentifier of {element.tag} is {name!r}"


@RULES.add(
    "X47",
    "Vendor annotations have names of their own",
    "2.2.6",
    "Give every Tool of VendorAnnotations another name, or put what belongs to one tool into one element.",
)
def _annotations(package: Package) -> Iterator[str]:
    names = [tool.get("name") for tool in package.root.iterfind("VendorAnnotations/Tool")]
    yield from (f"VendorAnnotations has more than one Tool of the name {name!r}" for name in repeated(names))


@RULES.add(
    "X48",
    "Source files are listed once",
    "4.3.1",
    "Take the repeated File out of SourceFiles: compiled twice, its functions are defined twice.",
)
def _listed_twice(package: Package) -> Iterator[str]:
    for element in package.root.iterfind("*[@modelIdentifier]"):
        names = [file.get("name") for file in element.iterfind("SourceFiles/File")]
        yield from (f"SourceFiles of {element.tag} lists {name!r} more than once" for name in repeated(names))


@RULES.add("X7", "The model has a name", "good practice", "Give modelName the name a user knows the model by.")
def _name(package: Package) -> Iterator[str]:
    if not package.root.get("modelName").strip():
        yield f"modelName is {package.root.get('modelName')!r}"


@RULES.add(
    "X8",
    "The GUID is there",
    "2.2.1",
    "Write a string that changes with every export that changes a variable, for example a UUID in braces.",
)
def _guid(package: Package) -> Iterator[str]:
    guid = package.guid
    if not guid.strip() or guid != guid.strip() or not guid.isascii():
        yield f"guid is {guid!r}"


@RULES.add(
    "X9",
    "The generation date is of the form YYYY-MM-DDThh:mm:ssZ",
    "2.2.1",
    "Write the date in UTC with a final Z, for example 2026-01-31T12:00:00Z; an offset such as +00:00 is not allowed.",
)
def _date(package: Package) -> Iterator[str]:
    date = package.root.get("generationDateAndTime")
    if date is None:
        raise NotApplicable("there is no generationDateAndTime")
    if not _DATE.fullmatch(date):
        yield f"generationDateAndTime is {date!r}"
    elif datetime.fromisoformat(date).year > datetime.now(UTC).year + 1:
        yield f"generationDateAndTime is {date!r}, which is in the future"


@RULES.add(
    "X10",
    "Capability flags agree with each other",
    "4.3.1",
    "Set canGetAndSetFMUstate too, or take canSerializeFMUstate back: a state must be got before it can be serialised.",
)
def _flags(package: Package) -> Iterator[str]:
    for element in package.root.iterfind("*[@canSerializeFMUstate]"):
        flags = [element.get(name) in ("true", "1") for name in ("canSerializeFMUstate", "canGetAndSetFMUstate")]
        if flags == [True, False]:
            yield f"{element.tag} has canSerializeFMUstate without canGetAndSetFMUstate"


@RULES.add(
    "X11",
    "Log categories have names of their own",
    "2.2.4",
    "Give every Category another, non-empty name.",
)
def _categories(package: Package) -> Iterator[str]:
    names = [category.get("name") for category in package.root.iterfind("LogCategories/Category")]
    yield from (f"the log category {name!r} is declared more than once" for name in repeated(names))
    if any(not name.strip() for name in names):
        yield "a log category has an empty name"


@RULES.add(
    "X12",
    "The default experiment can be run",
    "2.2.5",
    "Make startTime and stopTime finite with start before stop, and stepSize and tolerance positive.",
)
def _experiment(package: Package) -> Iterator[str]:
    experiment = package.root.find("DefaultExperiment")
    if experiment is None:
        raise NotApplicable("there is no DefaultExperiment")
    values = {name: float(text) for name, text in experiment.attrib.items()}
    yield from (f"{name} is {value}" for name, value in values.items() if not math.isfinite(value))
    yield from (f"{name} is {values[name]}" for name in ("stepSize", "tolerance") if values.get(name, 1.0) <= 0)
    start, stop, step = values.get("startTime", 0.0), values.get("stopTime"), values.get("stepSize", 0.0)
    if stop is not None and stop <= start:
        yield f"stopTime is {stop}, which is not after startTime {start}"
    elif stop is not None and step > stop - start:
        yield f"stepSize {step} is longer than the experiment from {start} to {stop}"
