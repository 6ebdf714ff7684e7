"""Files of SSP that cannot be run: one sentence each, with the file, the line, the component and what to do."""

from __future__ import annotations

import shutil
import zipfile
from pathlib import Path

import pytest
from ssp_files import (
    binding,
    bound,
    component,
    connected,
    connections,
    elements,
    gain,
    packed,
    ran,
    ssd,
)

from cosim.errors import CosimError

GAIN = "u=input k=parameter y=output"
ONE = component("c", "gain.fmu", GAIN)
TWO = elements(ONE, component("d", "gain.fmu", GAIN))
INFINITE = '<ssc:LinearTransformation factor="INF"/>'
MAP = "<ssc:IntegerMappingTransformation>{}</ssc:IntegerMappingTransformation>"
ENTRY = '<ssc:MapEntry source="1" target="{}"/>'


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("fmus")
    return [gain(folder / "gain.fmu", output_unit="m"), gain(folder / "hot.fmu", input_unit="K")]


@pytest.fixture
def folder(tmp_path: Path, fmus: list[Path]) -> Path:
    for fmu in fmus:
        shutil.copy(fmu, tmp_path)
    return tmp_path


def refused(folder: Path, text: str) -> str:
    """The sentence for a system beside the FMUs in the folder."""
    (folder / "test.ssd").write_text(text)
    with pytest.raises(CosimError) as error:
        ran(folder / "test.ssd", folder / "out")
    assert "\n" not in str(error.value)
    assert not (folder / "out").exists()
    return str(error.value).removeprefix(f"{folder}/")


def told(inner: str) -> str:
    system = f"<cosim:System>{inner}</cosim:System>"
    return f'<ssd:Annotations><ssc:Annotation type="cosim">{system}</ssc:Annotation></ssd:Annotations>'


SYSTEMS = {
    "no component": (connected("x=input"), "the system 'root' has no component, so nothing can run"),
    "no source": (
        elements(ONE.replace('source="gain.fmu"', "")),
        "line 4, component 'c': ssd:Component: the attribute 'source' is required but missing; give the component the",
    ),
    "empty source": (elements(component("c", "")), "line 4: component 'c' has no source; give it the URI of its FMU"),
    "missing file": (elements(component("c", "resources/a.fmu")), "line 4: there is no file"),
    "backslash": (elements(component("c", r"resources\a.fmu")), "has a backslash; folders in a URI end with /"),
    "http": (elements(component("c", "https://x.org/a.fmu")), "is not on this machine; fetch it and refer to the file"),
    "model exchange": (
        elements(component("c", "gain.fmu", implementation="ModelExchange")),
        "line 4: component 'c' asks for model exchange; only co-simulation can run",
    ),
    "type": (elements(component("c", "gain.fmu", type="text/x-modelica")), "component 'c' is of type text/x-modelica"),
    "twice": (elements(ONE, ONE), "line 5: 'root' has two elements named 'c'; name one of them otherwise"),
    "punning": (
        elements(component("s.c", "gain.fmu"), f'<ssd:System name="s">{elements(ONE)}</ssd:System>'),
        "the system has two instances named s.c; name one of them otherwise",
    ),
    "connector twice": (elements(component("c", "gain.fmu", "u=input u=input")), "'c' has two connectors named 'u'"),
    "no variable": (
        elements(component("c", "gain.fmu", "v=input")),
        "unknown variable of 'c' (Foreign) 'v'; known are k,",
    ),
    "another kind": (
        elements(component("c", "gain.fmu", "k=input")),
        "line 4: connector c.k is of kind input, but in Foreign it is a parameter; make the two alike",
    ),
    "another type": (
        elements(component("c", "gain.fmu", "u=input:Boolean")),
        "line 4: connector c.u is a Boolean, but in Foreign it is a Real; make the two alike",
    ),
    "binary": (elements(component("c", "gain.fmu", "u=input:Binary")), "c.u is Binary, which FMI 2.0 has not"),
    "kind": (elements(component("c", "gain.fmu", "u=local")), "connector 'u': ssd:Connector, attribute 'kind'"),
    "element": (TWO + connections("e.y d.u"), "line 7: unknown element of the system 'root' 'e'; known are c, d"),
    "port": (TWO + connections("c.y d.v"), "line 7: unknown variable of 'd' (Foreign) 'v'"),
    "system port": (TWO + connections("x d.u"), "unknown connector of the system 'root' 'x'; known are none"),
    "fed twice": (
        TWO + connections("c.y d.u", "d.y d.u"),
        "line 8: d.u is fed twice, by d.y and by c.y (",
    ),
    "two outputs": (TWO + connections("c.y d.y"), "line 7: c.y and d.y both give values; connect one to an input"),
    "two inputs": (TWO + connections("c.u d.u"), "line 7: c.u and d.u both take values; connect one to an output"),
    "into a parameter": (
        TWO + connections("c.y d.k"),
        "line 7: c.y -> d.k: an output cannot feed a parameter, which stays as it is while the system runs",
    ),
    "units": (
        elements(ONE, component("h", "hot.fmu")) + connections("c.y h.u"),
        "line 7: c.y -> h.u: the units m and K do not measure the same quantity",
    ),
    "circle": (
        f'<ssd:Elements><ssd:System name="s">{connected("i=input o=output")}{connections("i o")}</ssd:System>{ONE}'
        "</ssd:Elements>" + connections("s.o s.i", "s.o c.u"),
        "closes a circle without an FMU; take one of it out",
    ),
    "map": (
        TWO + connections(f"c.y d.u {MAP.format(ENTRY.format(1) + ENTRY.format(2))}"),
        "line 7: the map has two entries for 1; keep one",
    ),
    "infinite": (TWO + connections(f"c.y d.u {INFINITE}"), "factor and offset must be finite"),
    "value": (
        elements(component("c", "gain.fmu", "", binding({"k": '<ssv:String value="x"/>'}))),
        "c.k = x is not a number",
    ),
    "binary value": (
        elements(component("c", "gain.fmu", "", binding({"k": '<ssv:Binary value="00"/>'}))),
        "the value is Binary, which FMI 2.0 has not; take it out",
    ),
    "values twice": (
        elements(
            component(
                "c",
                "gain.fmu",
                "",
                binding({"k": 1.0}).replace(
                    "<ssv:Parameters>", '<ssv:Parameters><ssv:Parameter name="k"><ssv:Real value="1"/></ssv:Parameter>'
                ),
            )
        ),
        "the set has two values of 'k'; keep one",
    ),
    "inline": (
        bound(binding({"k": 1.0}).replace('<ssv:Real value="1.0"/>', '<ssv:Real value="much"/>')) + TWO,
        "parameter 'k': ssv:Real, attribute 'value': 'much' is not a valid value",
    ),
    "no values": (bound("<ssd:ParameterBinding/>") + TWO, "there must be a source, or a parameter set inside"),
    "format": (
        bound('<ssd:ParameterBinding type="text/csv" source="a.csv"/>') + TWO,
        "a parameter set of type text/csv",
    ),
    "base": (bound('<ssd:ParameterBinding source="a.ssv" sourceBase="component"/>') + TWO, "write SSD"),
    "no dictionary": (
        elements(ONE, '<ssd:SignalDictionaryReference name="r" dictionary="bus"/>') + connections("c.y r.speed"),
        "there is no signal dictionary 'bus'; 'r' wants one",
    ),
    "told of nobody": (TWO + told('<cosim:Instance element="e" period="1"/>'), "unknown element 'e'; known are c, d"),
    "told no time": (TWO + told('<cosim:Instance element="c" period="x"/>'), "period = 'x' is no time in seconds"),
    "told no kind": (
        TWO + told('<cosim:Instance element="c" kind="x"/>'),
        "kind 'x' is neither continuous nor sampled",
    ),
    "told no element": (TWO + told('<cosim:Event time="1"/>'), "the Event has no element; give one"),
    "itself": (
        elements(component("c", "test.ssd", type="application/x-ssp-definition")),
        "contains itself; take it out",
    ),
    "own system": (
        f'<ssd:Elements><ssd:System name="s" id="s">{elements(component("c", "#s"))}</ssd:System></ssd:Elements>',
        "component 'c' is '#s', which contains itself; take it out",
    ),
    "no system": (elements(component("c", "#s")), "refers to the system '#s', which is not there"),
    "order": (
        connections("c.y d.u") + TWO,
        "system 'root': ssd:Elements: this element is not expected; expected is one of (ssd:Sig",
    ),
}


@pytest.mark.parametrize("case", SYSTEMS)
def test_systems_that_cannot_be(folder: Path, case: str) -> None:
    system, expected = SYSTEMS[case]
    sentence = refused(folder, ssd(system))
    assert expected in sentence
    assert sentence.startswith("test.ssd, line ")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("<x", "test.ssd, line 1: this is no XML: "),
        ("<x/>", "test.ssd, line 1: this is no SystemStructureDescription of SSP but the element x"),
        (ssd(TWO, version="Draft20180219"), "line 2: version 'Draft20180219' of SSP cannot be read; 1.0 and 2.0 can"),
        (ssd(TWO).replace("?>\n", '?>\n<!DOCTYPE x [<!ENTITY a "b">]>'), "declares a document type or entities"),
        (ssd(TWO, end='<ssd:DefaultExperiment stopTime="0"/>'), "ends at 0 s, not after its start at 0 s"),
        (ssd(TWO, end='<ssd:DefaultExperiment stopTime="INF"/>'), "must be finite numbers"),
        (
            ssd(elements(component("c", "gain.fmu", "u=input:Int8")), version="2.0"),
            "ssc:Int8: this element is not expected",
        ),
        (ssd(elements(component("c", "gain.fmu", "u=structuralParameter")), version="2.0"), "connector 'u'"),
    ],
)
def test_files_that_are_none(folder: Path, text: str, expected: str) -> None:
    assert expected in refused(folder, text)


def test_what_an_archive_must_not_do(folder: Path) -> None:
    fmu = folder / "gain.fmu"
    outside = {"SystemStructure.ssd": ssd(elements(component("c", "../../gain.fmu"))), "resources/gain.fmu": fmu}
    slip = {"SystemStructure.ssd": ssd(elements(ONE)), "../gain.fmu": fmu}
    missing = {"SystemStructure.ssd": ssd(elements(ONE))}
    cases = {
        r"SystemStructure\.ssd, line 4: '\.\./\.\./gain\.fmu' leads out of t\.ssp; pack the file into it": outside,
        r"has the entry '\.\./gain\.fmu', which leads out of the archive": slip,
        r"^t\.ssp: SystemStructure\.ssd, line 4: t\.ssp has no file 'gain\.fmu'; pack it, or mend": missing,
        r"t\.ssp has no SystemStructure\.ssd, so it is no system structure package": {"x.ssd": ssd(elements(ONE))},
    }
    for expected, members in cases.items():
        packed(folder / "t.ssp", members)
        with pytest.raises(CosimError, match=expected):
            ran(folder / "t.ssp", folder / "out")
    (folder / "t.ssp").write_bytes(b"no archive")
    with pytest.raises(CosimError, match=r"t\.ssp is not a readable zip archive"):
        ran(folder / "t.ssp", folder / "out")


def test_packages_within_packages_come_to_an_end(folder: Path) -> None:
    text = ssd(elements(component("c", "inner.ssp", type="application/x-ssp-package")))
    packed(folder / "0.ssp", {"SystemStructure.ssd": text})
    for depth in range(22):
        packed(folder / f"{depth + 1}.ssp", {"SystemStructure.ssd": text, "inner.ssp": folder / f"{depth}.ssp"})
    with pytest.raises(CosimError, match="which is nested more than 20 deep; take it out"):
        ran(folder / "22.ssp", folder / "out")


def test_files_within_files_come_to_an_end(folder: Path) -> None:
    """Each holds the next twice: a million systems from twenty small files."""
    for depth in range(19):
        parts = [component(name, f"{depth + 1}.ssd", type="application/x-ssp-definition") for name in "ab"]
        (folder / f"{depth}.ssd").write_text(ssd(elements(*parts)))
    (folder / "19.ssd").write_text(ssd(TWO))
    with pytest.raises(CosimError, match="the system has more than 20000 elements"):
        ran(folder / "0.ssd", folder / "out")


def test_depth_has_an_end(folder: Path) -> None:
    """Within one file, and over many files that each go as deep as XML may."""
    deep = ONE
    for _ in range(100):
        deep = f'<ssd:System name="s">{elements(deep)}</ssd:System>'
    for depth in range(18):
        inner = component("c", f"{depth + 1}.ssd", type="application/x-ssp-definition")
        (folder / f"{depth}.ssd").write_text(ssd(elements(deep.replace(ONE, inner))))
    (folder / "18.ssd").write_text(ssd(TWO))
    with pytest.raises(CosimError, match=r"0\.ssd are nested too deep to be read"):
        ran(folder / "0.ssd", folder / "out")
    for _ in range(100):
        deep = f'<ssd:System name="s">{elements(deep)}</ssd:System>'
    assert "this is no XML: Excessive depth" in refused(folder, ssd(elements(deep)))


def test_fmus_that_are_none(folder: Path) -> None:
    """Of another version, or no archive at all: named as the file has it."""
    with zipfile.ZipFile(folder / "old.fmu", "w") as archive:
        archive.writestr("modelDescription.xml", '<fmiModelDescription fmiVersion="3.0"/>')
    assert "old.fmu" in refused(folder, ssd(elements(component("c", "old.fmu"))))
    (folder / "none.fmu").write_text("none")
    assert "none.fmu is not a readable zip archive" in refused(folder, ssd(elements(component("c", "none.fmu"))))


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ({"periods": [("x", 1.0)]}, "unknown instance 'x'; known are c"),
        ({"assignments": [("c.x", "1")]}, r"unknown variable of c"),
    ],
)
def test_what_the_user_says(folder: Path, options: dict[str, object], expected: str) -> None:
    (folder / "test.ssd").write_text(ssd(elements(ONE)))
    with pytest.raises(CosimError, match=expected):
        ran(folder / "test.ssd", folder / "out", **options)
