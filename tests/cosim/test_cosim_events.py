"""Values set during the run: the exact tick, both kinds of slave, and everything a user can get wrong."""

from __future__ import annotations

import json
import logging
import math
import zipfile
from dataclasses import replace
from pathlib import Path

import fmpy.ssp
import pytest
from cosim_mocks import Mock, assembled, face, faces_of, plan_of, scenario_of, simulate
from lxml import etree

from cosim.command import main as cli
from cosim.command import terminal
from cosim.command.explain import explanation
from cosim.errors import CosimError
from cosim.model.face import Port
from cosim.model.parsing import parse_events
from cosim.model.system import System
from cosim.results.reading import Facts, load_results
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.definition import Scenario
from cosim.scenario.discovery import load
from cosim.ssp.export import export
from cosim.ssp.namespaces import COSIM, SSD

LIMITED = Port("valve", 0, "input", minimum=0.0, maximum=1.0, unit="m", start=0.125)


def pair(*events: tuple[float, str, object]) -> tuple[System, dict[str, Mock]]:
    """A sampled source (20 ms) that feeds a plant (5 ms); both have an unconnected `valve`."""
    system = System()
    system.add("source", "Mock")
    system.add("plant", "Mock")
    system.connect("source", "plant", {"a": "a"})
    for time, signal, value in events:
        system.at(time, signal, value)  # type: ignore[arg-type]
    mocks = {
        "source": Mock(face({}, {"a": "m"}, step=0.02, extra=(LIMITED,)), lambda t, h, u: {"a": t}),
        "plant": Mock(
            face({"a": "m"}, {"y": "m"}, step=0.005, continuous=True, extra=(LIMITED,)), lambda t, h, u: {"y": t}
        ),
    }
    return system, mocks


def log_of(mock: Mock) -> list[tuple[object, ...]]:
    return [entry for entry in mock.log[1:] if entry[0] in ("set", "step")]


@pytest.mark.parametrize("scheme", ["multirate", "jacobi"])
def test_values_are_set_before_the_first_step_at_or_after_their_time(scheme) -> None:
    events = ((0.0, "plant.valve", 0.1), (0.006, "plant.valve", 0.2), (0.02, "source.valve", 1))
    system, mocks = pair(*events)
    outcome, _ = simulate(system, mocks, 0.041, scheme)
    assert outcome.status == "ok"
    assert log_of(mocks["plant"])[:5] == [
        ("set", {"valve": 0.1}),
        ("step", 0.0),
        ("step", 0.005),
        ("set", {"valve": 0.2}),
        ("step", 0.01),
    ]
    assert log_of(mocks["source"]) == [("step", 0.0), ("set", {"valve": 1.0}), ("step", 0.02), ("step", 0.04)]


def test_events_hold_beyond_the_first_cycle_and_in_the_cut_last_step() -> None:
    system, mocks = pair((0.1, "plant.valve", 0.5), (0.1235, "plant.valve", 0.25))
    simulate(system, mocks, 0.127)
    log = log_of(mocks["plant"])
    assert log[log.index(("set", {"valve": 0.5})) + 1] == ("step", 0.1)
    assert log[-2:] == [("set", {"valve": 0.25}), ("step", 0.125)]


def test_changed_inputs_are_recorded_from_their_start_value_on() -> None:
    system, mocks = pair((0.006, "plant.valve", 0.5), (0.02, "source.valve", 1.0))
    system.set("source.valve", 0.25)
    _, rows = simulate(system, mocks, 0.03)
    assert [row["plant.valve"] for row in rows] == [0.125, 0.125, 0.5, 0.5, 0.5, 0.5, 0.5]
    assert [row["source.valve"] for row in rows] == [0.25] * 4 + [1.0] * 3


def test_events_after_the_end_change_nothing() -> None:
    rows = [simulate(*pair(*events), 0.05)[1] for events in ((), ((9.0, "plant.valve", 1.0),))]
    assert [{**row, "plant.valve": 0.125} for row in rows[0]] == rows[1]


def test_the_later_call_replaces_an_event_at_the_same_time() -> None:
    system, mocks = pair((0.01, "plant.valve", 0.5), (0.01, "plant.valve", 0.75))
    simulate(system, mocks, 0.02)
    assert [entry for entry in log_of(mocks["plant"]) if entry[0] == "set"] == [("set", {"valve": 0.75})]


def test_a_pattern_sets_all_that_have_the_input() -> None:
    system, mocks = pair((0.01, "*.valve", 0.5), (0.02, "plan?.valve", 0.75))
    simulate(system, mocks, 0.03)
    of = {name: [e for e in log_of(mock) if e[0] == "set"] for name, mock in mocks.items()}
    assert of == {"source": [("set", {"valve": 0.5})], "plant": [("set", {"valve": 0.5}), ("set", {"valve": 0.75})]}
    system, mocks = pair((0.01, "*.b", 0.5))
    with pytest.raises(CosimError, match=r"unknown input of the instances that fit '\*\.b' 'b'; known are a, valve"):
        assembled(system, faces_of(mocks))


def test_a_pattern_is_a_matter_of_inputs_only_where_there_is_one() -> None:
    system, mocks = pair()
    system.add("other", "Mock")
    system.at(0.01, "*.valve", 0.5)
    nodes = assembled(system, faces_of(mocks) | {"other": face({}, {"y": "m"})})
    assert {name: len(node.changes) for name, node in nodes.items()} == {"source": 1, "plant": 1, "other": 0}


@pytest.mark.parametrize(
    ("event", "sentence"),
    [
        ((1.0, "plnt.valve", 1.0), "unknown instance 'plnt'; did you mean plant"),
        ((1.0, "plant.vlave", 1.0), "unknown input of plant .* 'vlave'; did you mean valve"),
        ((1.0, "plant.a", 1.0), r"plant.a cannot be set, as it is connected: source.a -> plant.a"),
        ((1.0, "plant.y", 1.0), "plant.y cannot change during the run: it is no input of Mock"),
        ((1.0, "plant.valve", "much"), "plant.valve = much is not a number"),
        ((1.0, "plant.valve", 2.0), r"plant.valve = 2 m is outside its range 0 ... 1 m"),
        ((math.nan, "plant.valve", 1.0), "plant.valve cannot be set at nan s; give a time from 0 to"),
        ((math.inf, "plant.valve", 1.0), "plant.valve cannot be set at inf s"),
        ((-1.0, "plant.valve", 1.0), "plant.valve cannot be set at -1 s"),
    ],
)
def test_mistakes_are_one_sentence(event, sentence) -> None:
    with pytest.raises(CosimError, match=sentence):
        system, mocks = pair(event)
        assembled(system, faces_of(mocks))


def test_the_form_of_the_command_line() -> None:
    assert parse_events(["3.0:mpc.motor_available.rr=0", "1e-1: a.b = 2"]) == [
        (3.0, "mpc.motor_available.rr", "0"),
        (0.1, "a.b", "2"),
    ]
    for text in ("a.b=1", "3:a=1", "3:a.b", "x:a.b=1", "3;a.b=1"):
        with pytest.raises(CosimError, match=r"write --at time:instance.variable=value"):
            parse_events([text])


def test_the_explanation_lists_them() -> None:
    system, mocks = pair((0.006, "plant.valve", 0.5), (2.0, "source.valve", 1.0))
    tables = dict(explanation(plan_of(system, mocks)))
    columns = [list(column.cells) for column in tables["values set during the run"].columns]
    assert columns == [
        ["0.006 s", "2 s"],
        ["plant.valve", "source.valve"],
        ["0.5 m", "1.0 m"],
        ["0.01 s", "never: after the end"],
    ]
    assert "inputs that hold their start value" not in tables


def tanks() -> Scenario:
    """Two tanks: the first takes in 2 from 0.5 s on, the second what the first has."""

    def build(_settings, _prepared):
        system = System()
        system.add("first", "Tank", period=0.01)
        system.add("second", "Tank", period=0.01)
        system.connect("first", "second", {"inflow": "level"})
        system.at(0.5, "first.inflow", 2.0)
        return system

    return scenario_of("tanks", build)


def test_an_fmu_sees_its_inputs_change_when_they_should(tank, tmp_path) -> None:
    """level' = inflow - level by Euler steps, written again as a loop."""
    request = Request(tanks(), tmp_path, [("first.inflow", "1.5")], events=[(0.75, "first.inflow", "0")])
    finished = run(replace(request, find=lambda model: tank))
    assert finished.summary.status == "ok"
    results = finished.results
    levels = [1.0]
    for k in range(100):
        inflow = 1.5 if k < 50 else 2.0 if k < 75 else 0.0
        levels.append(levels[-1] + 0.01 * (inflow - levels[-1]))
    assert results["first.level"].tolist() == pytest.approx(levels, abs=1e-12)
    assert results["first.inflow"].tolist() == [1.5] * 50 + [2.0] * 25 + [0.0] * 26


def test_an_event_of_the_user_beyond_the_end_is_an_error_one_of_the_scenario_is_not(tank, tmp_path) -> None:
    request = Request(tanks(), tmp_path, find=lambda model: tank)
    assert run(replace(request, stop_time=0.3)).summary.status == "ok"
    for time in (1.0, 2.5, 0.995):
        for signal in ("first.inflow", "f*.inflow"):
            with pytest.raises(CosimError, match=rf"first.inflow cannot be set at {time:g} s: the run ends at 1 s"):
                run(replace(request, events=[(time, signal, "1")]))


def test_an_exported_system_keeps_them_as_an_annotation_and_says_so(tank, tmp_path, caplog) -> None:
    export(Request(tanks(), tmp_path, find=lambda model: tank), tmp_path / "tanks.ssp")
    assert [r.message for r in caplog.records] == [
        "SSP 1.0 has no place for 1 value that changes during the run: an annotation keeps it, other tools ignore it"
    ]
    with zipfile.ZipFile(tmp_path / "tanks.ssp") as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
    schema = Path(fmpy.ssp.__file__).parent / "schema" / "SystemStructureDescription.xsd"
    etree.XMLSchema(etree.parse(schema)).assertValid(root)
    event = root.find(f"{{{SSD}}}System/{{{SSD}}}Annotations//{{{COSIM}}}Event")
    assert dict(event.attrib) == {"time": "0.5", "element": "first", "connector": "inflow", "value": "2.0"}


def test_a_table_travels_in_the_fmu_that_reads_it(tmp_path, monkeypatch) -> None:
    """The exported ReferenceTrajectory plays its trajectory from anywhere, without the file it was made from."""
    file = tmp_path / "here" / "straight.csv"
    file.parent.mkdir()
    file.write_text("time,x,y,course,speed,acceleration,curvature\n0,5,7,0,20,0,0\n9,185,7,0,20,0,0\n")
    assignments = [("reference.trajectory_file", str(file))]
    export(Request(load("lateral-tracking"), tmp_path, assignments), tmp_path / "l.ssp")
    with zipfile.ZipFile(tmp_path / "l.ssp") as archive:
        archive.extractall(tmp_path / "unpacked")
    with zipfile.ZipFile(tmp_path / "unpacked" / "resources" / "ReferenceTrajectory.fmu") as archive:
        assert b'start="straight.csv"' in archive.read("modelDescription.xml")
    file.unlink()
    monkeypatch.chdir(tmp_path)

    def build(_settings, _prepared):
        system = System()
        fmu = tmp_path / "unpacked" / "resources" / "ReferenceTrajectory.fmu"
        system.add("reference", str(fmu), {"trajectory_file": "straight.csv"})
        return system

    finished = run(Request(scenario_of("r", build), tmp_path / "out"))
    results = load_results(tmp_path / "out", Facts({"reference": 0.02}))
    assert finished.summary.status == "ok", finished.summary.reason
    assert results["reference.reference.y"][-1] == 7.0
    assert results["reference.reference.x"][0] == 5.0


def test_the_command(monkeypatch, tmp_path, capsys) -> None:
    """A push of the tracking car, and the same push from the beginning."""
    yaw = []
    for option, value in (("--at", "0.1:plant.body_force.y=500"), ("--set", "plant.body_force.y=500")):
        line = ["run", "lateral-tracking", "--stop-time", "0.3", "--json", "--no-report", "-o", str(tmp_path)]
        monkeypatch.setattr("sys.argv", ["cosim", *line, "--set", "scenario.feedback=truth", option, value])
        with pytest.raises(SystemExit) as end:
            cli.main()
        assert end.value.code == 0
        assert json.loads(capsys.readouterr().out)["status"] == "ok"
        results = load_results(tmp_path, Facts({}))
        yaw.append(results["plant.acceleration.y"])
        time = results.time
    assert abs(yaw[0][time < 0.1]).max() < 0.05 < abs(yaw[0][time > 0.105]).max()
    assert abs(yaw[1][time < 0.02]).max() > 0.2


def test_notices_are_shown_on_stderr_or_not_at_all(capsys, caplog) -> None:
    log = logging.getLogger("cosim")
    for shown in (True, False):
        terminal.notices(shown=shown)
        log.info("planning %s", "x")
    captured = capsys.readouterr()
    assert captured.err == "cosim: planning x\n"
    assert captured.out == ""
    assert caplog.messages == ["planning x"] * 2
