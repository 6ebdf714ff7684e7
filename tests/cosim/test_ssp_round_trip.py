"""What is exported runs again as it ran: all columns of the results are equal to the bit."""

from __future__ import annotations

import json
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import fmpy.ssp
import pyarrow.parquet as pq
import pytest
from lxml import etree
from small_c import foreign, variable
from ssp_files import binding, component, connected, connections, elements, gain, packed, ran, ssd

from cosim.command.opening import opened
from cosim.errors import CosimError
from cosim.model.system import System
from cosim.model.transformation import Lookup, Transformation
from cosim.model.units import Conversion
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.definition import Scenario
from cosim.scenario.described import Description, scenario_of
from cosim.scenario.discovery import load, names
from cosim.ssp.export import export
from cosim.ssp.namespaces import PREFIXES, SCHEMAS
from cosim.system_file.writing import export_system

ENUMERATION = '<SimpleType name="{}"><Enumeration>{}</Enumeration></SimpleType>'
MODES = '<Item name="off" value="1"/><Item name="on" value="2"/>'
STATES = '<Item name="aus" value="3"/><Item name="ein" value="7"/>'
TYPES = ENUMERATION.format("Mode", MODES) + ENUMERATION.format("State", STATES)
SAYING = (
    "static char said[2][80]; static int k; k = !k; "
    'snprintf(said[k], 80, "%s+%d", m->name, m->steps % 3); v[0] = said[k];'
)
SHORT = ["lateral-tracking", "motor-failure"]


def valid(file: Path) -> etree._Element:
    """The description in an archive, after it and every parameter set was held against its schema."""
    folder = Path(fmpy.ssp.__file__).parent / "schema"
    with zipfile.ZipFile(file) as archive:
        for name in archive.namelist():
            if name.endswith((".ssd", ".ssv")):
                root = etree.fromstring(archive.read(name))
                etree.XMLSchema(etree.parse(folder / SCHEMAS[root.tag])).assertValid(root)
        return etree.fromstring(archive.read("SystemStructure.ssd"))


def same(scenario: Scenario, folder: Path, **options: object) -> Path:
    """Export, run both, and compare; the archive."""
    file = export(Request(scenario, folder, **options), folder / "made.ssp")
    valid(file)
    before = run(Request(scenario, folder / "before", **options))
    after = ran(file, folder / "after")
    assert (before.summary.status, after.summary.status) == ("ok", "ok") or before.summary.status == "missed"
    tables = [pq.read_table(folder / name / "results.parquet") for name in ("before", "after")]
    assert tables[0].column_names == tables[1].column_names
    assert tables[0].num_rows == tables[1].num_rows > 1
    for name in tables[0].column_names:
        assert tables[0][name].equals(tables[1][name]), name
    return file


@pytest.mark.parametrize("name", SHORT)
def test_scenarios_come_back(tmp_path: Path, name: str) -> None:
    events = [(0.1, "plant.body_force.y", "500"), (0.15, "plant.body_force.y", "0")]
    same(load(name), tmp_path, stop_time=0.2, seed=3, events=events)


@pytest.mark.nightly
@pytest.mark.parametrize("name", names())
def test_all_scenarios_come_back(tmp_path: Path, name: str) -> None:
    same(load(name), tmp_path, stop_time=0.5)


def counter(file: Path, mode: str = "Mode") -> Path:
    """Outputs of every type that change from step to step, and an input for each."""
    discrete = {"variability": "discrete"}
    kinds = [("i", "Integer", "0"), ("b", "Boolean", "false"), ("e", "Enumeration", "1" if mode == "Mode" else "3")]
    ports = [variable("x", 0, "input", start="0"), variable("y", 1, "output", unit="mm")]
    for place, (name, kind, start) in enumerate(kinds, start=2):
        more = {"declaredType": mode} if kind == "Enumeration" else {}
        ports.append(variable(name, place, "input", kind, start=start, **more, **discrete))
        ports.append(variable(f"{name}_out", place + 5, "output", kind, **more, **discrete))
    ports.append(variable("s", 0, "input", "String", start="", **discrete))
    ports.append(variable("s_out", 1, "output", "String", **discrete))
    items = "1 + m->steps % 2" if mode == "Mode" else "m->i[4]"
    step = (
        f"m->steps++; m->r[1] += h + m->r[0]; m->i[7] = m->steps + m->i[2]; m->i[8] = m->steps % 2; m->i[9] = {items};"
    )
    calls = {
        "fmi2DoStep": step,
        "fmi2SetString": 'snprintf(m->name, sizeof m->name, "%s", v[0]);',
        "fmi2GetString": SAYING,
    }
    units = '<Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>'
    return foreign(file, ports, calls, types=TYPES, units=units)


@pytest.fixture
def typed(tmp_path: Path) -> Scenario:
    """Two of every kind of element: instances, values, connections with and without steps, maps, events, units."""
    one, two = counter(tmp_path / "one.fmu"), counter(tmp_path / "two ü.fmu", "State")
    metres = gain(tmp_path / "metres.fmu", input_unit="m")
    system = System()
    system.add("a.1", str(one), {"i": 4, "e": "on"}, period=0.02, kind="sampled")
    system.add("a-1", str(two), {"b": True, "s": "first"}, period=0.03)
    system.add("2", str(metres), {"k": 3.0}, period=0.01)
    system.add("2.k", str(metres), {"k": 0.1}, period=0.01)
    system.connect("a.1", "2", {"u": "y"})
    system.connect("a-1", "2.k", {"u": "y"})
    system.link(("a.1", "i_out"), ("a-1", "i"), Transformation((Lookup(tuple((k, 32 - k) for k in range(99))),)))
    system.link(("a.1", "e_out"), ("a-1", "e"), Transformation((Lookup(((1, 7), (2, 3)), partial=True),)))
    system.link(("a-1", "b_out"), ("a.1", "b"), Transformation((Lookup(((0, 1), (1, 0))),)))
    system.link(("2", "y"), ("a-1", "x"), Transformation((Conversion(0.1, 1e-17),)))
    system.link(("a-1", "s_out"), ("a.1", "s"))
    system.at(0.1, "a.1.x", 1.0 / 3.0)
    system.at(0.2, "a.1.x", 0.0)
    return scenario_of(Description("two of a kind", "t", system, 0.5, 0.01, ("**.s_out",)))


def test_every_kind_of_element_comes_back(tmp_path: Path, typed: Scenario) -> None:
    root = valid(same(typed, tmp_path))
    count = {name: len(root.findall(f".//{name}", PREFIXES)) for name in COUNTS}
    assert count == COUNTS
    names_ = [each.get("name") for each in root.iterfind(".//ssd:Component", PREFIXES)]
    assert names_ == ["a_1", "a_1_2", "x2", "x2_k"]


COUNTS = {
    "ssd:Component": 4,
    "ssd:ParameterBinding": 4,
    "ssc:LinearTransformation": 3,
    "ssc:IntegerMappingTransformation": 1,
    "ssc:BooleanMappingTransformation": 1,
    "ssc:EnumerationMappingTransformation": 1,
    "ssc:Enumeration/ssc:Item": 4,
    "cosim:Event": 2,
    "cosim:Instance": 4,
    "cosim:Unrecorded": 1,
}


def test_other_tools_find_what_they_want(tmp_path: Path, typed: Scenario) -> None:
    """OMSimulator: its annotation is the first of the system, none is in a component, and all names are identifiers."""
    root = valid(export(Request(typed, tmp_path), tmp_path / "t.ssp"))
    annotations = root.findall("ssd:System/ssd:Annotations/ssc:Annotation", PREFIXES)
    assert [each.get("type") for each in annotations] == ["org.openmodelica", "cosim"]
    master = annotations[0].find("oms:Annotations/oms:SimulationInformation/oms:FixedStepMaster", PREFIXES)
    assert (master.get("description"), master.get("stepSize")) == ("oms-ma", "0.01")
    assert root.find(".//ssd:Component/ssd:Annotations", PREFIXES) is None
    assert all(each.get("name").isidentifier() for each in root.iter(*(f"{{{PREFIXES['ssd']}}}{k}" for k in KINDS)))


KINDS = ("SystemStructureDescription", "System", "Component")


def test_two_steps_are_more_than_ssp_knows(tmp_path: Path, typed: Scenario) -> None:
    system = typed.work().build({}, None)
    steps = Transformation((Lookup(((1, 2),)), Conversion(2.0)))
    system.links[0] = replace(system.links[0], transformation=steps)
    with pytest.raises(CosimError, match=r"a\.1\.i_out -> a-1\.i has 2 steps on its way"):
        export(Request(scenario_of(Description("t", "t", system, 0.1)), tmp_path), tmp_path / "t.ssp")


TABLE = "time,x,y,course,speed,acceleration,curvature\n{0},0,0,0,{1},0,0\n9,{2},0,0,{1},0,0\n"


def test_tables_travel_in_their_fmus(tmp_path: Path) -> None:
    """Two instances of one model with a table each become two FMUs that start with it; the third stays as it is.

    In one process, that has run the model without a table before.
    """
    system = System()
    for name, speed in (("first", 2), ("second", 3), ("third", 0)):
        file = tmp_path / f"{name}.csv"
        file.write_text(TABLE.format(0, speed, 9 * speed))
        system.add(name, "ReferenceTrajectory", {"trajectory_file": str(file)} if speed else {})
    file = same(scenario_of(Description("tables", "t", system, 0.2)), tmp_path)
    with zipfile.ZipFile(file) as archive:
        assert sorted(name for name in archive.namelist() if name.endswith(".fmu")) == [
            "resources/ReferenceTrajectory-2.fmu",
            "resources/ReferenceTrajectory-3.fmu",
            "resources/ReferenceTrajectory.fmu",
        ]
        assert not [name for name in archive.namelist() if name.endswith(".ssv")]
        fmu = Path(archive.extract("resources/ReferenceTrajectory.fmu", tmp_path))
    assert 'start="first.csv"' in zipfile.ZipFile(fmu).read("modelDescription.xml").decode()
    command = [sys.executable, "-m", "fmus", "check", "--json", str(fmu)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert [entry for entry in json.loads(done.stdout) if entry["status"] == "fail"] == []


def test_what_was_read_is_written_again(tmp_path: Path) -> None:
    """A nested system of another tool, exported flat."""
    fmu = gain(tmp_path / "gain.fmu", input_unit="m")
    inner = elements(component("c", "resources/gain.fmu", "y=output", binding({"k": 2.0, "u": 3.0})))
    nested = f'<ssd:System name="s">{inner}</ssd:System>'
    again = nested.replace('name="s"', 'name="t"')
    text = ssd(f"<ssd:Elements>{nested}{again}</ssd:Elements>")
    first = packed(tmp_path / "first.ssp", {"SystemStructure.ssd": text, "resources/gain.fmu": fmu})
    with opened(str(first)) as scenario:
        root = valid(same(scenario, tmp_path))
    assert [each.get("name") for each in root.iterfind(".//ssd:Component", PREFIXES)] == ["s_c", "t_c"]


def test_an_ssp_becomes_a_system_file(tmp_path: Path, typed: Scenario) -> None:
    """With its FMUs beside it, its connections and their transformations."""
    packed_ = export(Request(typed, tmp_path), tmp_path / "typed.ssp")
    with opened(str(packed_)) as scenario:
        file = export_system(Request(scenario, tmp_path), tmp_path / "typed.toml")
        before = run(Request(scenario, tmp_path / "before"))
    after = ran(file, tmp_path / "after")
    assert after.summary.status == before.summary.status == "ok"
    tables = [pq.read_table(tmp_path / name / "results.parquet") for name in ("before", "after")]
    assert all(tables[0][name].equals(tables[1][name]) for name in tables[0].column_names)
    assert tables[0].column_names == tables[1].column_names


def calculating(file: Path) -> Path:
    """Calculates a mass, a count, a flag and a name while it initialises, and takes such as parameters."""
    fixed = {"variability": "fixed"}
    ports = [variable("y", 3, "output"), variable("size", 0, "parameter", start="2", initial="exact", **fixed)]
    for place, (name, kind, start) in enumerate([("m", "Real", "0"), ("n", "Integer", "0"), ("b", "Boolean", "false")]):
        ports.append(variable(f"its_{name}", place + 4, "parameter", kind, start=start, initial="exact", **fixed))
        ports.append(variable(name, place + 8, "calculatedParameter", kind, initial="calculated", **fixed))
    ports.append(variable("its_s", 0, "parameter", "String", start="", initial="exact", **fixed))
    ports.append(variable("s", 1, "calculatedParameter", "String", initial="calculated", **fixed))
    calculated = "m->r[8] = 10 * m->r[0] + m->r[4]; m->i[9] = 3 + m->i[5]; m->i[10] = !m->i[6];"
    calls = {
        "fmi2GetReal": f"{calculated} for (size_t i = 0; i < n; ++i) v[i] = m->r[vr[i]];",
        "fmi2GetInteger": f"{calculated} for (size_t i = 0; i < n; ++i) v[i] = m->i[vr[i]];",
        "fmi2GetBoolean": f"{calculated} for (size_t i = 0; i < n; ++i) v[i] = m->i[vr[i]];",
        "fmi2SetString": 'snprintf(m->name, sizeof m->name, "%s", v[0]);',
        "fmi2GetString": 'static char s[80]; snprintf(s, 80, "%.40s!", m->steps ? m->name : m->name); v[0] = s;',
        "fmi2ExitInitializationMode": "m->r[3] = m->r[4] + m->i[5] + m->i[6];",
        "fmi2DoStep": "m->r[3] += 1000;",
    }
    return foreign(file, ports, calls)


def test_what_one_calculates_feeds_parameters_of_another(tmp_path: Path) -> None:
    """Through a connector of a system, with a transformation; also twice in a row; and again once exported."""
    calculating(tmp_path / "c.fmu")
    kinds = "m=calculatedParameter n=calculatedParameter:Integer b=calculatedParameter:Boolean"
    kinds += " s=calculatedParameter:String"
    inner = connected(kinds) + elements(component("c", "c.fmu", "", binding({"size": 4.0})))
    inner += connections("c.m m", "c.n n", "c.b b", "c.s s")
    last_ = component("e", "c.fmu", "", binding({"its_m": 7.0}))
    parts = elements(f'<ssd:System name="s">{inner}</ssd:System>', component("d", "c.fmu"), last_)
    half = '<ssc:LinearTransformation factor="0.5"/>'
    into = [f"s.m d.its_m {half}", "s.n d.its_n", "s.b d.its_b", "s.s d.its_s"]
    joined = connections(*into, "d.m e.its_m", "d.n e.its_n", "d.s e.its_s")
    (tmp_path / "t.ssd").write_text(ssd(parts + joined))
    for n, path in enumerate([tmp_path / "t.ssd", tmp_path / "again.ssp"]):
        results = ran(path, tmp_path / str(n)).results
        assert [results[f"{name}.y"][0] for name in "de"] == [20.0 + 3.0 + 1.0, 20.0 + 6.0]
        assert (results["s.c.m"][0], results["d.m"][0], results["d.n"][0]) == (40.0, 20.0, 6.0)
        assert (results["s.c.s"].tolist()[0], results["d.s"].tolist()[0]) == ("s.c!", "s.c!!")
        with opened(str(path)) as scenario:
            valid(export(Request(scenario, tmp_path), tmp_path / "again.ssp"))
