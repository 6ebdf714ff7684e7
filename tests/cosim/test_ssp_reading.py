"""Systems of SSP files: nested, connected through all levels, with units, transformations and values of all levels."""

from __future__ import annotations

import json
import math
import re
import shutil
import zipfile
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from small_c import foreign, variable
from ssp_files import (
    SPACES,
    binding,
    bound,
    component,
    connected,
    connections,
    elements,
    gain,
    last,
    packed,
    parameters,
    ran,
    ssd,
)

from cosim.command import main as cli
from cosim.errors import CosimError
from cosim.model.parsing import parse_periods

GAIN = "u=input k=parameter y=output"
THREE = '<ssc:LinearTransformation factor="3"/>'


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return gain(tmp_path_factory.mktemp("fmus") / "gain.fmu")


@pytest.fixture
def fmu(tmp_path: Path, made: Path) -> Path:
    return Path(shutil.copy(made, tmp_path))


@pytest.fixture
def folder(tmp_path: Path, fmu: Path) -> Path:
    return tmp_path


def run_of(folder: Path, system: str, signal: str, **options: object) -> float:
    """The last value of the signal in a run of a system beside the FMUs in the folder."""
    (folder / "test.ssd").write_text(ssd(system, **{key: options.pop(key) for key in ("version",) if key in options}))
    return last(folder / "test.ssd", folder / "out", signal, **options)


def test_a_linear_transformation(folder: Path) -> None:
    chain = elements(
        component("a", "gain.fmu", GAIN, binding({"u": 2.0}) + binding({"u": 3.0})), component("b", "gain.fmu", GAIN)
    )
    shifted = '<ssc:LinearTransformation factor="1.3" offset="50"/>'
    assert run_of(folder, chain + connections(f"a.y b.u {shifted}"), "b.y") == pytest.approx(53.9)
    assert run_of(folder, chain + connections(f"b.u a.y {shifted}"), "b.y") == pytest.approx(53.9), (
        "no direction in start"
    )


NESTED = """<ssd:System name="sub">{connectors}{bindings}{elements}{connections}</ssd:System>"""


def nested(outer: str = "", inner: str = "", own: str = "") -> str:
    """A gain in a system in the root, connected through both; bindings of the root, the system, the FMU."""
    through = connections("u c.u", "k c.k", "c.y y")
    sub = NESTED.format(
        connectors=connected(GAIN.replace("y=output", "y=output")),
        bindings=bound(inner),
        elements=elements(component("c", "gain.fmu", GAIN, own)),
        connections=through,
    )
    ports = connected("x=input z=output")
    return ports + bound(outer) + elements(sub) + connections("x sub.u", "sub.y z")


@pytest.mark.parametrize(
    ("outer", "inner", "own", "expected"),
    [
        ("", "", "", 1.0),
        ("", "", binding({"u": 2.0, "k": 3.0}), 6.0),
        ("", binding({"c.u": 5.0}), binding({"u": 2.0, "k": 3.0}), 15.0),
        (binding({"sub.c.u": 7.0}), binding({"c.u": 5.0}), binding({"u": 2.0, "k": 3.0}), 21.0),
        (binding({"x": 11.0}), "", binding({"u": 2.0, "k": 3.0}), 33.0),
        ("", binding({"k": 4.0}), binding({"u": 2.0, "k": 3.0}), 8.0),
        (binding({"sub.k": 5.0}), binding({"k": 4.0}), binding({"u": 2.0}), 10.0),
        (binding({"sub.k": 5.0}) + binding({"sub.k": 6.0}), "", "", 6.0),
        (binding({"k": 5.0, "nobody": 2.0}, prefix="sub."), "", "", 5.0),
        (binding({"p": 5.0, "q": 9.0}, '<ssm:MappingEntry source="p" target="sub.k"/>'), "", "", 5.0),
        (binding({"p": 5.0}, f'<ssm:MappingEntry source="p" target="sub.k">{THREE}</ssm:MappingEntry>'), "", "", 15.0),
        (binding({"p": 5.0}, '<ssm:MappingEntry source="v.p" target="x"/>', prefix="v."), "", "", 5.0),
        (
            binding(
                {"p": 5.0}, '<ssm:MappingEntry source="p" target="sub.k"/><ssm:MappingEntry source="p" target="x"/>'
            ),
            "",
            "",
            25.0,
        ),
    ],
)
def test_values_of_all_levels(folder: Path, outer: str, inner: str, own: str, expected: float) -> None:
    assert run_of(folder, nested(outer, inner, own), "sub.c.y") == expected


def test_values_in_files_beside_and_inside(folder: Path) -> None:
    """Sources relative to the SSD, and to the FMU; mappings in files too."""
    (folder / "my values.ssv").write_text(parameters({"gain of it": 4.0}))
    entries = '<ssm:MappingEntry source="gain of it" target="k"/>'
    (folder / "m.ssm").write_text(parameters({}).partition("<ssv")[0] + _mapping(entries))
    outside = (
        '<ssd:ParameterBinding source="my%20values.ssv"><ssd:ParameterMapping source="m.ssm"/></ssd:ParameterBinding>'
    )
    assert run_of(folder, elements(component("c", "gain.fmu", GAIN, outside)), "c.y") == 4.0
    add(folder / "gain.fmu", "resources/own.ssv", parameters({"k": 5.0}))
    inside = '<ssd:ParameterBinding source="resources/own.ssv" sourceBase="component"/>'
    assert run_of(folder, elements(component("c", "gain.fmu", GAIN, inside)), "c.y") == 5.0


def _mapping(entries: str) -> str:
    return f'<ssm:ParameterMapping version="1.0" {SPACES}>{entries}</ssm:ParameterMapping>'


def add(file: Path, name: str, content: str) -> None:
    with zipfile.ZipFile(file, "a") as archive:
        archive.writestr(name, content)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ('<ssv:Real value="25" unit="degC"/>', 298.15),
        ('<ssv:Real value="25"/>', 25.0),
        ('<ssv:Integer value="25"/>', 25.0),
    ],
)
def test_units_of_values(tmp_path: Path, value: str, expected: float) -> None:
    gain(tmp_path / "gain.fmu", input_unit="K")
    inside = elements(component("c", "gain.fmu", GAIN, binding({"u": value})))
    assert run_of(tmp_path, inside, "c.y") == pytest.approx(expected)
    through = connected("x=input:K") + bound(binding({"x": value})) + elements(component("c", "gain.fmu"))
    assert run_of(tmp_path, through + connections("x c.u"), "c.y") == pytest.approx(expected)
    mapped = binding({"v": value}, f'<ssm:MappingEntry source="v" target="u">{THREE}</ssm:MappingEntry>')
    assert run_of(tmp_path, elements(component("c", "gain.fmu", "", mapped)), "c.y") == pytest.approx(3 * expected)
    plain = '<ssm:MappingEntry source="v" target="u" suppressUnitConversion="true"/>'
    mapped = binding({"v": value}, plain)
    assert run_of(tmp_path, elements(component("c", "gain.fmu", "", mapped)), "c.y") == 25.0


DEGREE = math.pi / 180.0


@pytest.mark.parametrize(
    ("giving", "taking", "connection", "expected"),
    [
        ("", "", "", 10.0 * DEGREE),
        (":deg", ":rad", "", 10.0 * DEGREE),
        (":rad", ":deg", "", 10.0 * DEGREE),
        ("", "", "suppress", 10.0),
        ("", "", '<ssc:LinearTransformation offset="1"/>', 10.0 * DEGREE + 1.0),
        ("", ":deg", '<ssc:LinearTransformation offset="10"/>', 20.0 * DEGREE),
        (":rad", "", '<ssc:LinearTransformation offset="1"/>', 10.0 * DEGREE + 1.0),
        ("", "", 'suppress<ssc:LinearTransformation factor="2"/>', 20.0),
        (":rad", ":deg", 'suppress<ssc:LinearTransformation factor="2"/>', 20.0),
    ],
)
def test_units_of_connections(tmp_path: Path, giving: str, taking: str, connection: str, expected: float) -> None:
    """10 deg into rad; units that connectors declare come between, and a transformation follows the conversion."""
    gain(tmp_path / "deg.fmu", output_unit="deg")
    gain(tmp_path / "rad.fmu", input_unit="rad")
    both = elements(
        component("a", "deg.fmu", f"y=output{giving}", binding({"u": 10.0})),
        component("b", "rad.fmu", f"u=input{taking}"),
    )
    assert run_of(tmp_path, both + connections(f"a.y b.u {connection}"), "b.y") == pytest.approx(expected)


def test_a_unit_that_the_file_does_not_define_is_that_of_the_fmu(tmp_path: Path) -> None:
    gain(tmp_path / "deg.fmu", output_unit="deg")
    gain(tmp_path / "rad.fmu", input_unit="rad")
    both = elements(component("a", "deg.fmu", "y=output:deg"), component("b", "rad.fmu", "u=input:rad"))
    text = re.sub("<ssd:Units>.*</ssd:Units>", "", ssd(both + connections("a.y b.u")))
    (tmp_path / "test.ssd").write_text(text)
    assert last(tmp_path / "test.ssd", tmp_path / "out", "b.y") == pytest.approx(DEGREE)


def test_a_unit_passes_a_connector_without_one(tmp_path: Path) -> None:
    gain(tmp_path / "deg.fmu", output_unit="deg")
    gain(tmp_path / "rad.fmu", input_unit="rad")
    inner = connected("i=input") + elements(component("b", "rad.fmu", "u=input")) + connections("i b.u")
    both = elements(
        component("a", "deg.fmu", "y=output", binding({"u": 180.0})), f'<ssd:System name="s">{inner}</ssd:System>'
    )
    assert run_of(tmp_path, both + connections("a.y s.i"), "s.b.y") == pytest.approx(math.pi)


MODES = [("Mode", "off on"), ("State", "aus ein")]
TYPES = "".join(
    f'<SimpleType name="{name}"><Enumeration>'
    + "".join(f'<Item name="{item}" value="{k + 1 + 5 * n}"/>' for k, item in enumerate(items.split()))
    + "</Enumeration></SimpleType>"
    for n, (name, items) in enumerate(MODES)
)
ECHO = {
    "fmi2DoStep": "m->i[4] = m->i[0]; m->i[5] = m->i[1]; m->i[6] = m->i[2];",
    "fmi2SetString": 'snprintf(m->name, sizeof m->name, "%s", v[0]);',
    "fmi2GetString": "v[0] = m->name;",
}


def echo(file: Path, mode: str) -> Path:
    """Puts out what it takes: an Integer, a Boolean, an Enumeration and a String."""
    discrete, ports = {"variability": "discrete"}, []
    starts = [("i", "Integer", "7"), ("b", "Boolean", "false"), ("e", "Enumeration", "1"), ("s", "String", "")]
    for place, (name, kind, start) in enumerate(starts):
        declared = {"declaredType": mode} if kind == "Enumeration" else {}
        first = "6" if (kind, mode) == ("Enumeration", "State") else start
        ports.append(variable(name, place, "input", kind, start=first, **declared, **discrete))
        ports.append(variable(f"{name}_out", place + 4, "output", kind, **declared, **discrete))
    return foreign(file, ports, ECHO, types=TYPES)


def test_ports_of_all_types_and_maps(tmp_path: Path) -> None:
    echo(tmp_path / "a.fmu", "Mode")
    echo(tmp_path / "b.fmu", "State")
    values = {
        "i": '<ssv:Integer value="32"/>',
        "b": '<ssv:Boolean value="true"/>',
        "e": '<ssv:Enumeration value="on"/>',
        "s": '<ssv:String value="grün &amp; blau"/>',
    }
    integers = (
        '<ssc:IntegerMappingTransformation><ssc:MapEntry source="32" target="1"/></ssc:IntegerMappingTransformation>'
    )
    booleans = (
        '<ssc:BooleanMappingTransformation><ssc:MapEntry source="true" target="0"/>'
        '<ssc:MapEntry source="false" target="1"/></ssc:BooleanMappingTransformation>'
    )
    items = (
        '<ssc:EnumerationMappingTransformation><ssc:MapEntry source="off" target="aus"/>'
        '<ssc:MapEntry source="on" target="ein"/></ssc:EnumerationMappingTransformation>'
    )
    ports = (
        "i=input:Integer b=input:Boolean s=input:String i_out=output:Integer b_out=output:Boolean s_out=output:String"
    )
    system = elements(component("a", "a.fmu", ports, binding(values)), component("b", "b.fmu", ports))
    joined = connections(f"a.i_out b.i {integers}", f"a.b_out b.b {booleans}", f"a.e_out b.e {items}", "a.s_out b.s")
    (tmp_path / "test.ssd").write_text(ssd(system + joined))
    results = ran(tmp_path / "test.ssd", tmp_path / "out", scheme="jacobi").results
    found = {name: results[f"b.{name}"][-1] for name in ("i_out", "b_out", "e_out", "s_out")}
    assert found == {"i_out": 1, "b_out": False, "e_out": 7, "s_out": "grün & blau"}
    other = values | {"i": '<ssv:Integer value="5"/>', "e": '<ssv:Integer value="1"/>'}
    (tmp_path / "test.ssd").write_text(
        ssd(system.replace(values["i"], other["i"]).replace(values["e"], other["e"]) + joined)
    )
    results = ran(tmp_path / "test.ssd", tmp_path / "out", scheme="jacobi").results
    assert (results["b.i_out"][-1], results["b.e_out"][-1]) == (5, 6), "what a map does not name stays"


@pytest.mark.parametrize("where", ["beside", "packed", "unpacked", "up", "absolute"])
def test_sources_are_uris(tmp_path: Path, where: str) -> None:
    inner = tmp_path / "in ner"
    inner.mkdir()
    fmu = gain(inner / "größe #1 50%.fmu")
    encoded = "gr%C3%B6%C3%9Fe%20%231%2050%25.fmu"
    source = {"up": f"../in%20ner/{encoded}", "absolute": fmu.as_uri()}.get(where, f"resources/{encoded}")
    text = ssd(elements(component("c", source, GAIN, binding({"u": 6.0}))))
    members = {"SystemStructure.ssd": text, f"resources/{fmu.name}": fmu}
    path = tmp_path / "sys"
    if where == "packed":
        path = packed(tmp_path / "sys.ssp", members)
    else:
        (path / "resources").mkdir(parents=True)
        (path / "SystemStructure.ssd").write_text(text)
        (path / "resources" / fmu.name).write_bytes(fmu.read_bytes())
        path = path / "SystemStructure.ssd" if where in ("beside", "up") else path
    assert last(path, tmp_path / "out", "c.y") == 6.0


def test_a_name_that_is_not_encoded_is_found(tmp_path: Path) -> None:
    gain(tmp_path / "50%41.fmu")
    assert run_of(tmp_path, elements(component("c", "50%41.fmu", GAIN)), "c.y") == 1.0


def test_nested_packages_and_descriptions(tmp_path: Path, fmu: Path) -> None:
    """Bindings of the component come after those of the nested system; variants; a system used twice."""
    inner = (
        connected("u=input y=output")
        + bound(binding({"c.k": 2.0}))
        + elements(component("c", "resources/gain.fmu", GAIN))
    )
    inner += connections("u c.u", "c.y y")
    other = inner.replace('value="2.0"', 'value="3.0"')
    members = {"SystemStructure.ssd": ssd(inner), "Other.ssd": ssd(other), "resources/gain.fmu": fmu}
    nested_package = packed(tmp_path / "inner.ssp", members)
    (tmp_path / "lone.ssd").write_text(ssd(inner.replace("resources/", "")))
    package = {"type": "application/x-ssp-package"}
    system = elements(
        component("a", "resources/in.ssp", "u=input y=output", **package),
        component("b", "resources/in.ssp#Other.ssd", "u=input y=output", **package),
        component("c", "resources/in.ssp", "u=input y=output", binding({"c.k": 7.0}), **package),
        '<ssd:System name="d" id="twice">'
        + elements(component("e", "gain.fmu", GAIN, binding({"k": 13.0})))
        + "</ssd:System>",
        component("f", "#twice", bindings=binding({"e.u": 2.0})),
    )
    joined = connections("a.y b.u", "b.y c.u")
    text = ssd(system + joined)
    file = packed(
        tmp_path / "outer.ssp", {"SystemStructure.ssd": text, "resources/in.ssp": nested_package, "gain.fmu": fmu}
    )
    results = ran(file, tmp_path / "out", stop_time=1.0).results
    values = {name: results[f"{name}.y"][-1] for name in ("a.c", "b.c", "c.c", "d.e", "f.e")}
    assert values == {"a.c": 2.0, "b.c": 6.0, "c.c": 42.0, "d.e": 13.0, "f.e": 26.0}
    assert last(f"{tmp_path}/inner.ssp#Other.ssd", tmp_path / "out", "c.y") == 3.0
    outside = component("x", "lone.ssd", "u=input", type="application/x-ssp-definition")
    assert run_of(tmp_path, elements(outside), "x.c.y") == 2.0


def test_signal_dictionaries_are_buses(folder: Path) -> None:
    """What one reference writes the others read, also those in a system below; a name is looked up outwards."""
    spaces = parameters({}).partition("<ssv:Parameters>")[0].partition('name="values"')[2].removesuffix(">")
    entry = '<ssb:DictionaryEntry name="speed"><ssc:Real unit="mm"/></ssb:DictionaryEntry>'
    unit = '<ssb:Units><ssc:Unit name="mm"><ssc:BaseUnit m="1" factor="0.001"/></ssc:Unit></ssb:Units>'
    inline = f'<ssb:SignalDictionary version="1.0" {spaces}>{entry}{unit}</ssb:SignalDictionary>'
    bus = f'<ssd:SignalDictionary name="bus">{inline}</ssd:SignalDictionary>'
    bus = f"<ssd:SignalDictionaries>{bus}</ssd:SignalDictionaries>"
    gain(folder / "metres.fmu", input_unit="m", output_unit="m")
    reference = (
        '<ssd:SignalDictionaryReference name="{0}" dictionary="bus">'
        + connected("speed=inout:mm")
        + "</ssd:SignalDictionaryReference>"
    )
    sub = elements(component("b", "metres.fmu", GAIN), reference.format("here")) + connections("here.speed b.u")
    system = elements(
        component("a", "metres.fmu", "y=output", binding({"u": 5.0})),
        reference.format("top"),
        f'<ssd:System name="s">{sub}</ssd:System>',
    )
    assert run_of(folder, system + connections("a.y top.speed") + bus, "s.b.y") == pytest.approx(5.0)


def test_what_ssp_leaves_open(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Periods, kinds, names and events from our annotation, periods from the user; a start other than 0 is told."""
    told = (
        '<ssd:Annotations><ssc:Annotation type="cosim"><cosim:System recordEvery="0.2">'
        '<cosim:Unrecorded pattern="b.*"/>'
        '<cosim:Instance element="a" name="first" period="0.05" kind="sampled"/>'
        '<cosim:Instance element="b" period="0.1"/>'
        '<cosim:Event time="0.4" element="a" connector="u" value="9"/>'
        "</cosim:System></ssc:Annotation></ssd:Annotations>"
    )
    system = elements(component("a", "gain.fmu", GAIN), component("b", "gain.fmu", GAIN)) + told
    (folder / "test.ssd").write_text(ssd(system, end='<ssd:DefaultExperiment startTime="2" stopTime="3"/>'))
    finished = ran(folder / "test.ssd", folder / "out", periods=[("b", 0.2)])
    nodes = finished.plan.nodes
    assert {name: (node.period, node.kind) for name, node in nodes.items()} == {
        "first": (50_000_000, "sampled"),
        "b": (200_000_000, "continuous"),
    }
    assert finished.results.time.tolist() == [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
    assert finished.results["first.y"].tolist() == [1.0, 1.0, 9.0, 9.0, 9.0, 9.0]
    assert not [name for name in finished.results.names if name.startswith("b.")]
    assert "its default experiment starts at 2 s; runs start at 0 s, so this one ends at 1 s" in caplog.text


def test_geometry_and_foreign_annotations_mean_nothing(folder: Path) -> None:
    geometry = '<ssd:ElementGeometry x1="0" y1="0" x2="1" y2="1"/>'
    foreign_ = (
        '<ssd:Annotations><ssc:Annotation type="org.example"><x xmlns="urn:x"/></ssc:Annotation></ssd:Annotations>'
    )
    first = component("a", "gain.fmu", GAIN).replace("</ssd:Connectors>", f"</ssd:Connectors>{geometry}")
    curve = '<ssd:ConnectionGeometry pointsX="1 2" pointsY="1 2"/>'
    system = elements(first, component("b", "gain.fmu", GAIN)) + connections(f"a.y b.u {curve}")
    place = 'x1="0" y1="0" x2="1" y2="1"'
    note = f'<ssd:GraphicalElements><ssd:Note {place} text="t"/></ssd:GraphicalElements>'
    note = f"<ssd:SystemGeometry {place}/>{note}"
    assert run_of(folder, system + note + foreign_, "b.y") == 1.0


def test_ssp_2_where_it_says_the_same(folder: Path) -> None:
    system = nested(binding({"sub.k": '<ssv:Float64 value="3"/>'}).replace('version="1.0"', 'version="2.0"'))
    system = system.replace("<ssc:Real/>", "<ssc:Float64/>")
    assert run_of(folder, system, "sub.c.y", version="2.0") == 3.0


def test_equal_runs_give_equal_files(folder: Path) -> None:
    """Wherever the archive was unpacked."""
    text = ssd(elements(component("c", "resources/gain.fmu", GAIN)))
    file = packed(folder / "t.ssp", {"SystemStructure.ssd": text, "resources/gain.fmu": folder / "gain.fmu"})
    made = []
    for name in "ab":
        ran(file, folder / name)
        made.append((folder / name / "results.parquet").read_bytes())
    assert made[0] == made[1]


@pytest.mark.parametrize("path", ["t.ssp", "folder", "folder/SystemStructure.ssd"])
def test_the_command(
    folder: Path, path: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """With the options of a scenario; the results have the name of the file."""
    text = ssd(elements(component("c", "resources/gain.fmu", GAIN)))
    packed(folder / "t.ssp", {"SystemStructure.ssd": text, "resources/gain.fmu": folder / "gain.fmu"})
    with zipfile.ZipFile(folder / "t.ssp") as archive:
        archive.extractall(folder / "folder")
    monkeypatch.chdir(folder)
    options = ["--set", "c.k=3", "--at", "0.1:c.u=2", "--period", "?=0.05", "--stop-time", "0.2", "--json", "--explain"]
    monkeypatch.setattr("sys.argv", ["cosim", "run", path, *options])
    with pytest.raises(SystemExit) as end:
        cli.main()
    printed = capsys.readouterr()
    assert end.value.code == 0
    assert json.loads(printed.out)["provenance"]["periods"] == ["?=0.05"]
    assert "50 ms" in printed.err
    values = pq.read_table(folder / "results" / Path(path).stem / "results.parquet")["c.y"].to_pylist()
    assert values == [3.0, 3.0, 3.0, 6.0, 6.0]


@pytest.mark.parametrize(("text", "expected"), [("car*=0.01", [("car*", 0.01)]), ("a=b=1", [("a=b", 1.0)])])
def test_periods_are_read(text: str, expected: list[tuple[str, float]]) -> None:
    assert parse_periods([text]) == expected


@pytest.mark.parametrize("text", ["x", "=1", "a=", "a=b"])
def test_periods_that_are_none(text: str) -> None:
    with pytest.raises(CosimError, match="write --period instance=seconds"):
        parse_periods([text])
