"""Exported systems: valid against the SSP 1.0 schema, complete, and the same bytes for the same request."""

import zipfile
from pathlib import Path
from urllib.parse import unquote

import fmpy.ssp
import pytest
from cosim_mocks import assembled, face, scenario_of
from lxml import etree

from cosim.command import main as cli
from cosim.errors import CosimError
from cosim.model.face import Port
from cosim.model.system import System
from cosim.run.request import Request
from cosim.scenario.discovery import load
from cosim.scenario.settings import chosen
from cosim.ssp.export import export
from cosim.ssp.names import identifiers
from cosim.ssp.namespaces import PREFIXES, SSV
from cosim.ssp.packing import Model
from cosim.ssp.writing import Outline, structure, values

NAMES = PREFIXES


def valid(document: bytes, schema: str) -> etree._Element:
    root = etree.fromstring(document)
    etree.XMLSchema(etree.parse(Path(fmpy.ssp.__file__).parent / "schema" / schema)).assertValid(root)
    return root


@pytest.fixture
def nodes():
    """A thermometer in deg C and mm feeding a heater in K and m, with parameters of every type."""
    parameters = (
        Port("gain", 0, "parameter"),
        Port("seed", 1, "parameter", "Integer"),
        Port("on", 2, "parameter", "Boolean"),
        Port("file", 3, "parameter", "String"),
    )
    system = System()
    system.add("car1.sensor", "Mock", {"gain": "1e-17", "seed": 7, "on": "true", "file": 'a<b>&"c"'})
    system.add("heater", "Mock", period=0.02)
    system.connect("car1.sensor", "heater")
    system.at(1.0, "heater.spare", 2.0)
    system.at(2.0, "heater.spare", 3.0)
    faces = {
        "car1.sensor": face({}, {"t": "degC", "d": "mm"}, extra=parameters),
        "heater": face({"t": "K", "d": "m", "spare": "m"}),
    }
    return assembled(system, faces)


@pytest.fixture
def root(nodes):
    models = {name: Model(Path("Mock.fmu"), "Mock.fmu") for name in nodes}
    sets = {"car1.sensor": "resources/car1.sensor.ssv"}
    outline = Outline("mocked & checked", nodes, models, sets, identifiers(nodes), 3_000_000_000)
    return valid(structure(outline), "SystemStructureDescription.xsd")


def test_conversions_are_written_out(root):
    """Tools that do convert units must not do it twice."""
    found = {
        c.get("endConnector"): (c.get("suppressUnitConversion"), *map(float, c[0].attrib.values()))
        for c in root.findall(".//ssd:Connection", NAMES)
    }
    assert found == {"t": ("true", 1.0, 273.15), "d": ("true", 0.001, 0.0)}


def test_every_unit_of_a_connector_is_defined(root):
    used = {kind.get("unit") for kind in root.findall(".//ssd:Connector/*", NAMES)}
    defined = {unit.get("name"): dict(unit[0].attrib) for unit in root.findall(".//ssd:Units/ssc:Unit", NAMES)}
    assert used == set(defined)
    assert defined["degC"] == {"K": "1", "offset": "273.15"}
    assert defined["mm"] == {"m": "1", "factor": "0.001"}


def test_components_connectors_and_periods(root):
    component = root.findall(".//ssd:Component", NAMES)
    assert [c.get("name") for c in component] == ["car1_sensor", "heater"]
    kinds = [(c.get("name"), c.get("kind")) for c in component[0].findall(".//ssd:Connector", NAMES)]
    assert kinds == [("t", "output"), ("d", "output")]
    told = [dict(instance.attrib) for instance in root.iterfind(".//cosim:Instance", NAMES)]
    assert told == [
        {"element": "car1_sensor", "name": "car1.sensor", "period": "0.01", "kind": "sampled"},
        {"element": "heater", "period": "0.02", "kind": "sampled"},
    ]
    assert root.find("ssd:DefaultExperiment", NAMES).get("stopTime") == "3.0"


def test_all_events_are_in_one_annotation(root):
    events = root.findall("ssd:System/ssd:Annotations/ssc:Annotation/cosim:System/cosim:Event", NAMES)
    assert [(event.get("time"), event.get("value")) for event in events] == [("1.0", "2.0"), ("2.0", "3.0")]


def test_values_of_every_type_survive(nodes):
    root = valid(values(nodes["car1.sensor"]), "SystemStructureParameterValues.xsd")
    found = {p.get("name"): (etree.QName(p[0]).localname, p[0].get("value")) for p in root.iter(f"{{{SSV}}}Parameter")}
    assert found == {
        "gain": ("Real", "1e-17"),
        "seed": ("Integer", "7"),
        "on": ("Boolean", "true"),
        "file": ("String", 'a<b>&"c"'),
    }


def two_tanks(again):
    def build(_settings, _prepared):
        system = System()
        system.add("first", "Tank", period=0.01)
        system.add("second", "Tank", {"fail_at": 5.0}, period=0.02)
        system.add("third", str(again))
        system.instances["third"].period = 0.01
        system.connect("first", "second", {"inflow": "level"})
        return system

    return scenario_of("tanks", build, stop_time=1.5)


def test_a_file_with_its_fmus_and_values(tank, tmp_path):
    again = tmp_path / "other" / tank.name
    again.parent.mkdir()
    again.write_bytes(tank.read_bytes())
    scenario = two_tanks(again)
    made = [
        export(Request(scenario, tmp_path, [("first.inflow", "2")], 3, find=lambda model: tank), tmp_path / f"{n}.ssp")
        for n in "ab"
    ]
    assert made[0].read_bytes() == made[1].read_bytes()
    with zipfile.ZipFile(made[0]) as archive:
        root = valid(archive.read("SystemStructure.ssd"), "SystemStructureDescription.xsd")
        sources = [component.get("source") for component in root.findall(".//ssd:Component", NAMES)]
        bindings = [binding.get("source") for binding in root.findall(".//ssd:ParameterBinding", NAMES)]
        assert {"SystemStructure.ssd", *sources, *bindings} == set(archive.namelist())
        assert all(archive.read(source) == tank.read_bytes() for source in sources)
        text = archive.read("resources/first.ssv")
    assert sources == [f"resources/{tank.name}", f"resources/{tank.name}", f"resources/{tank.stem}-2.fmu"]
    parameters = {p.get("name"): p[0].get("value") for p in etree.fromstring(text).iter(f"{{{SSV}}}Parameter")}
    assert parameters.keys() == {"inflow", "seed"}
    assert parameters["inflow"] == "2.0"


NAMED = ["one/Car.fmu", "two/Car.fmu", "Car-2.fmu", "two/CAR.fmu", "car#1.fmu", "car%41.fmu", "größe 1.fmu"]


def test_every_fmu_and_instance_has_a_file_of_its_own(tank, tmp_path):
    """Also where only the case differs, where a name looks numbered, and where a URI or a path means something else.

    No name has to be escaped, as not every tool reads escapes.
    """
    system, names = System(), ["Car", "car", "../x", "a/b", "a_b", "é", "c"]
    for name, file in zip(names, NAMED, strict=True):
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_bytes(tank.read_bytes())
        system.add(name, str(tmp_path / file), {"fail_at": 5.0}, period=0.01)
    scenario = scenario_of("named", lambda _settings, _prepared: system, stop_time=1.0)
    made = export(Request(scenario, tmp_path), tmp_path / "named.ssp")
    with zipfile.ZipFile(made) as archive:
        root = valid(archive.read("SystemStructure.ssd"), "SystemStructureDescription.xsd")
        members = archive.namelist()
    sources = [component.get("source") for component in root.findall(".//ssd:Component", NAMES)]
    bindings = [binding.get("source") for binding in root.findall(".//ssd:ParameterBinding", NAMES)]
    assert sorted(unquote(uri) for uri in sources + bindings) == sorted(set(members) - {"SystemStructure.ssd"})
    assert len({member.casefold() for member in members}) == len(members) == 2 * len(names) + 1
    assert sources[4:] == ["resources/car_1.fmu", "resources/car_41.fmu", "resources/gr__e_1.fmu"]
    assert all(member.count("/") <= 1 and ".." not in member for member in members)


def test_a_file_that_cannot_be_written(tank, tmp_path):
    (tmp_path / "x.ssp").mkdir()
    with pytest.raises(CosimError, match=r"cannot write .*x\.ssp: Is a directory"):
        export(Request(two_tanks(tank), tmp_path, find=lambda model: tank), tmp_path / "x.ssp")


def test_the_command(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr("sys.argv", ["cosim", "export", "lateral-tracking", "-o", str(tmp_path / "l.ssp")])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert (end.value.code, capsys.readouterr().out) == (0, f"{tmp_path}/l.ssp\n")
    with zipfile.ZipFile(tmp_path / "l.ssp") as archive:
        root = valid(archive.read("SystemStructure.ssd"), "SystemStructureDescription.xsd")
    scenario = load("lateral-tracking")
    settings = chosen(scenario.name, scenario.settings, [])
    system = scenario.work().build(settings, None)
    assert [c.get("name") for c in root.findall(".//ssd:Component", NAMES)] == list(system.instances)
