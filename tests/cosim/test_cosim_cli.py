"""The command line as a user meets it, on small FMUs made with plain PythonFMU."""

import hashlib
import json
import math
import sys
import zipfile
from functools import partial
from importlib import metadata
from pathlib import Path

import pytest
from cosim_mocks import scenario_of
from pyarrow import parquet

from cosim.command.main import main
from cosim.errors import CosimError
from cosim.model.system import System
from cosim.results.reading import Facts, load_results
from cosim.run.claim import claimed
from cosim.scenario.limit import Limit
from cosim.scenario.metric import Metric, choice, count, truth
from cosim.scenario.settings import NumberSetting, Setting

SUMMARY = {
    "scenario": str,
    "status": str,
    "reason": str,
    "stop_time": float,
    "wall_time": float,
    "real_time_factor": float,
    "record_every": float,
    "unrecorded": list,
    "seed": int,
    "command": str,
    "provenance": dict,
    "pace": type(None),
    "instances": dict,
    "metrics": dict,
    "units": dict,
    "limits": dict,
}


def measured(results, _prepared):
    return {
        "level_last": Metric(float(results["second.level"][-1]), "m"),
        "nothing": Metric(float("nan")),
        "asked": Metric(results.settings["period"], "s"),
        "poured": Metric(results.number("first", "inflow")),
        "tilt": Metric(math.pi / 2, "rad"),
        "spills": count(3.0),
        "decided": choice(1, ("open", "close")),
        "burst": truth(0.0),
    }


@pytest.fixture
def tanks(tmp_path):
    """tanks(**options): a scenario with the instances first and second, whose models are Tank or a file bad.fmu."""

    def build(settings, _prepared):
        system = System()
        system.add("first", "Tank" if settings["source"] == "good" else str(tmp_path / "bad.fmu"), period=0.01)
        system.add("second", "Tank", period=settings["period"])
        system.connect("first", "second", {"inflow": "level"})
        return system

    settings = {
        "source": Setting("good", ("good", "bad"), "which file"),
        "period": NumberSetting(0.02, 0.01, 0.5, "s", "period of the second tank"),
    }
    return partial(scenario_of, "tanks", build, settings=settings)


@pytest.fixture
def cosim(tank, tanks, offer, monkeypatch, capsys):
    """Runs `cosim ARGS`; gives (exit code, stdout, stderr)."""
    offer(tanks(metrics=measured), {"Tank": tank})

    def call(*args):
        monkeypatch.setattr(sys, "argv", ["cosim", *args])
        with pytest.raises(SystemExit) as end:
            main()
        captured = capsys.readouterr()
        return end.value.code or 0, captured.out, captured.err

    return call


def test_a_run_writes_results_and_summary(cosim, tmp_path):
    code, out, err = cosim("run", "tanks", "-o", str(tmp_path / "r"), "--set", "first.inflow=3", "--seed", "4")
    assert (code, err) == (0, "")
    assert "level_last" in out
    assert str(tmp_path / "r") in out.replace("\n", "")
    summary = json.loads((tmp_path / "r" / "summary.json").read_text())
    assert {name: type(value) for name, value in summary.items()} == SUMMARY
    assert (summary["status"], summary["seed"], summary["stop_time"]) == ("ok", 4, 1.0)
    assert summary["instances"]["first"].keys() == {"model", "period", "calls", "time"}
    assert [summary["instances"][name]["calls"] for name in ("first", "second")] == [100, 50]
    results = load_results(tmp_path / "r", Facts({"first": 0.01}))
    levels = [1.0]
    for _ in range(100):
        levels.append(levels[-1] + 0.01 * (3.0 - levels[-1]))
    assert results["first.level"].tolist() == pytest.approx(levels, rel=1e-15)
    assert summary["units"] == {
        "level_last": "m",
        "nothing": "1",
        "asked": "s",
        "poured": "1",
        "tilt": "rad",
    } | dict.fromkeys(("spills", "decided", "burst"), "1")
    tilt = next(line.replace("│", "").split() for line in out.splitlines() if "tilt" in line)
    assert tilt == ["tilt", "90.000", "deg"], "degrees for the reader"
    known = {"nothing": None, "asked": 0.02, "poured": 3.0, "tilt": math.pi / 2}
    told = {"spills": 3, "decided": "close", "burst": False}
    assert summary["metrics"] == {"level_last": results["second.level"][-1], **known, **told}
    assert type(summary["metrics"]["spills"]) is int
    rows = [line.replace("│", "").split() for line in out.splitlines()]
    assert [row[1] for row in rows if row[:1] in (["spills"], ["decided"], ["burst"])] == ["3", "close", "no"]


def test_a_run_says_what_it_was_made_of(cosim, tank, tmp_path):
    line = ["run", "tanks", "--set", "first.inflow=3", "--set", "scenario.period=0.05", "--at", "0.5:first.inflow=1"]
    for name in "ab":
        assert cosim(*line, "--seed", "4", "--quiet", "-o", str(tmp_path / name))[0] == 0
    summary = json.loads((tmp_path / "a" / "summary.json").read_text())
    made = summary["provenance"]
    assert summary["command"].split()[1:] == [*line, "--seed", "4", "--quiet", "-o", str(tmp_path / "a")]
    assert (made["settings"], made["at"]) == ({"source": "good", "period": 0.05}, ["0.5:first.inflow=1"])
    assert made["set"] == ["first.inflow=3", "scenario.period=0.05"]
    assert (made["seed"], made["stop"], made["scheme"], made["step"]) == (4, 1.0, "multirate", None)
    assert made["values"].keys() == {"first.inflow", "first.seed", "second.seed"}
    assert made["models"]["Tank"]["sha256"] == hashlib.sha256(tank.read_bytes()).hexdigest()
    assert made["versions"]["fmpy"] == metadata.version("fmpy")
    files = [(tmp_path / name / "results.parquet").read_bytes() for name in "ab"]
    assert files[0] == files[1]
    assert json.loads(parquet.read_schema(tmp_path / "a" / "results.parquet").metadata[b"cosim"]) == made


def test_many_vehicles_are_a_row_each(cosim, tanks, tank, offer, tmp_path):
    def many(_results, _prepared):
        figures = {"error_rms": Metric(0.5, "m"), "tilt": Metric(math.pi / 2, "rad")}
        each = {f"car{k}.{name}": metric for k in (2, 3) for name, metric in figures.items()}
        return each | {f"car2.figure{i}_with_a_long_name": Metric(float(i)) for i in range(30)} | {"worst": Metric(1.0)}

    offer(tanks(metrics=many), {"Tank": tank})
    _, out, _ = cosim("run", "tanks", "-o", str(tmp_path), "--no-report")
    rows = [line.replace("│", " ").split() for line in out.splitlines()]
    assert [row for row in rows if row[:1] == ["car3"]] == [["car3", "0.5000", "90.000"]]
    assert "more of each vehicle in summary.json" in out
    assert len(json.loads((tmp_path / "summary.json").read_text())["metrics"]) == 35


@pytest.mark.parametrize(("most", "status"), [(3.0, "ok"), (0.5, "missed")])
def test_a_run_is_held_against_the_limits_of_its_scenario(cosim, tanks, tank, offer, tmp_path, most, status):
    limits = [Limit("ran over", "poured", most=most), Limit("ran dry", "nothing", least=1.0)]
    offer(tanks(limits=limits, metrics=measured), {"Tank": tank})
    line = ["run", "tanks", "--set", "first.inflow=3", "-o", str(tmp_path), "--no-report"]
    code, out, _ = cosim(*line)
    summary = json.loads((tmp_path / "summary.json").read_text())
    reason = "ran over (poured = 3, at most 0.5)" if status == "missed" else ""
    assert (code, summary["status"], summary["reason"]) == (0, status, reason)
    assert out.startswith(f"tanks, seed 0: {status}\n{reason}")
    assert summary["limits"]["ran over"] == {
        "metric": "poured",
        "value": 3.0,
        "most": most,
        "least": None,
        "kept": status == "ok",
    }
    assert summary["limits"]["ran dry"]["kept"] is None, "what is not known is not held against the run"
    assert cosim(*line, "--strict")[0] == (0 if status == "ok" else 1)


def test_rows_only_every_so_often(cosim, tmp_path):
    code, _, _ = cosim("run", "tanks", "-o", str(tmp_path), "--record-every", "0.3", "--quiet")
    assert code == 0
    assert json.loads((tmp_path / "summary.json").read_text())["record_every"] == 0.3
    assert load_results(tmp_path, Facts({})).time.tolist() == [0.0, 0.3, 0.6, 0.9, 1.0]


@pytest.mark.parametrize(
    ("option", "value", "thing"),
    [
        ("--record-every", "-1", "the time between two recorded rows is -1 s"),
        ("--stop-time", "nan", "the stop time is nan s"),
        ("--stop-time", "1e300", "the stop time is 1e+300 s"),
    ],
)
def test_a_time_that_cannot_be_is_told_first(cosim, tanks, tank, offer, tmp_path, option, value, thing):
    assert cosim("run", "tanks", "-o", str(tmp_path), "--quiet")[0] == 0
    kept = (tmp_path / "results.parquet").read_bytes()
    prepared = []
    offer(tanks(prepare=prepared.append), {"Tank": tank})
    answer = cosim("run", "tanks", "-o", str(tmp_path), "--explain", option, value)
    assert answer == (2, "", f"cosim: {thing}; it must be positive and finite\n")
    assert not prepared
    assert (tmp_path / "results.parquet").read_bytes() == kept


def test_signals_left_out_are_recorded_when_asked_for(cosim, tanks, tank, offer, tmp_path):
    offer(tanks(unrecorded=("*.lev?l",)), {"Tank": tank})
    whole, part = tmp_path / "whole", tmp_path / "part"
    assert cosim("run", "tanks", "-o", str(whole), "--quiet", "--record-all")[0] == 0
    assert cosim("run", "tanks", "-o", str(part), "--quiet")[0] == 0
    names = [load_results(folder, Facts({})).names for folder in (whole, part)]
    assert names == [["first.level", "second.level"], []]
    left_out = [json.loads((folder / "summary.json").read_text())["unrecorded"] for folder in (whole, part)]
    assert left_out == [[], ["**.fault", "*.lev?l"]]


def test_json_is_all_that_goes_to_stdout(cosim, tmp_path):
    code, out, _ = cosim("run", "tanks", "-o", str(tmp_path), "--json", "--explain")
    assert code == 0
    assert json.loads(out)["scenario"] == "tanks"


def test_quiet_says_nothing(cosim, tmp_path):
    assert cosim("run", "tanks", "-o", str(tmp_path), "--quiet") == (0, "", "")


def test_a_number_is_a_setting(cosim, tmp_path):
    _, out, _ = cosim("run", "tanks", "-o", str(tmp_path), "--set", "scenario.period=0.1", "--json")
    summary = json.loads(out)
    assert summary["instances"]["second"]["period"] == summary["metrics"]["asked"] == 0.1


def test_settings_are_listed_with_choices_or_limits(cosim):
    assert "source=good|bad" in cosim("list")[1]
    assert "period=0.01 ... 0.5 s" in cosim("list")[1]
    settings = next(each["settings"] for each in json.loads(cosim("list", "--json")[1]) if each["name"] == "tanks")
    assert settings["source"] == {"default": "good", "choices": ["good", "bad"], "description": "which file"}
    limits = {"default": 0.02, "minimum": 0.01, "maximum": 0.5, "unit": "s", "whole": False}
    assert settings["period"] == {**limits, "description": "period of the second tank"}


def test_explain_shows_order_edges_and_free_inputs(cosim, tmp_path):
    _, out, _ = cosim("run", "tanks", "-o", str(tmp_path), "--explain")
    assert "base tick 10 ms" in out
    assert "delay: the value at the communication point" in out
    assert "inputs that hold their start value" in out


def test_the_same_seed_gives_the_same_bytes(cosim, tmp_path):
    for name in ("a", "b"):
        cosim("run", "tanks", "-o", str(tmp_path / name), "--seed", "3")
    files = [(tmp_path / name / "results.parquet").read_bytes() for name in ("a", "b")]
    assert files[0] == files[1]


@pytest.mark.parametrize(
    ("args", "sentence"),
    [
        (["run", "high-sped-tracking"], "unknown scenario 'high-sped-tracking'; did you mean high-speed-tracking"),
        (["run", "tanks", "--set", "fist.inflow=1"], "unknown instance 'fist'; did you mean first"),
        (["run", "tanks", "--set", "first.inflw=1"], "unknown variable of first (CosimTestTank) 'inflw'; did you mean"),
        (["run", "tanks", "--set", "scenario.sorce=bad"], "unknown setting of tanks 'sorce'; did you mean source"),
        (["run", "tanks", "--set", "scenario.source=ugly"], "scenario.source = 'ugly' is not one of good, bad"),
        (["run", "tanks", "--set", "scenario.period=1"], "scenario.period = 1 s is outside its range 0.01 ... 0.5 s"),
        (["run", "tanks", "--set", "scenario.period=x"], "scenario.period = 'x' is not a finite number; give one in"),
        (["run", "tanks", "--set", "scenario.period=nan"], "'nan' is not a finite number; give one in 0.01 ... 0.5 s"),
        (["run", "tanks", "--set", "first.inflow=nan"], "first.inflow = nan is not a finite number"),
        (["run", "tanks", "--set", "first.level=1"], "first.level is an output"),
        (["run", "tanks", "--set", "nonsense"], "cannot read 'nonsense'"),
        (["run", "tanks", "--stop-time", "0"], "the stop time is 0 s; it must be positive"),
        (["run", "tanks", "--set", "scenario.source=bad"], "there is no file"),
        (["run"], "name a scenario or the file of a system; `cosim list` shows the scenarios"),
        (["run", "tanks", "--seed", "two"], "Invalid value for '--seed'"),
        (["run", "tanks", "--colour"], "No such option: --colour"),
        (["run", "tanks", "extra"], "Got unexpected extra argument"),
        (["run", "no-such-file.toml"], "no-such-file.toml"),
        (["run", "tanks", "--set", "first.inflow"], "cannot read 'first.inflow'; write --set instance.variable=value"),
        (["run", "tanks", "--set", "inflow=1"], "cannot read 'inflow=1'; write --set instance.variable=value"),
        (["run", "tanks", "--set", "first.inflow=much"], "first.inflow = much is not a number"),
        (["run", "tanks", "--set", "first.seed=1.5"], "first.seed = 1.5 is not a whole number"),
        (["run", "tanks", "--set", "second.inflow=1"], "second.inflow cannot be set, as it is connected: first.level"),
        (["run", "tanks", "--set", "third*.inflow=1"], "no instance fits the pattern 'third*.inflow'"),
        (["run", "tanks", "--at", "first.inflow=1"], "write --at time:instance.variable=value"),
        (["run", "tanks", "--at", "5:first.inflow=1"], "the run ends at 1 s"),
        (["run", "tanks", "--at", "1e300:first.inflow=1"], "give a time from 0 to 1e+09 s"),
        (["run", "tanks", "--at", "0.5:first.fail_at=1"], "cannot change during the run: it is no input"),
        (["run", "tanks", "--step", "1e-10"], "the common step is 1e-10 s, which is not a whole number of nanoseconds"),
        (["run", "tanks", "--stop-time", "1e200"], "the stop time is 1e+200 s; it must be at most 1e+09 s"),
        (["run", "tanks", "--record-every", "nan"], "the time between two recorded rows is nan s"),
        (["run", "tanks", "--scheme", "gauss"], "Invalid value for '--scheme'"),
        (["run", "tanks", "--isolate", "thrid"], "unknown instance 'thrid'"),
        (["run", "tanks", "--isolate", "all", "--isolate-timeout", "0"], "the time-out of isolated instances is 0 s"),
    ],
)
def test_a_newcomers_mistakes_are_one_sentence_and_touch_nothing(cosim, tmp_path, args, sentence):
    code, out, err = cosim(*args, "-o", str(tmp_path / "r"))
    assert code == 2
    assert out == ""
    assert err.startswith("cosim: ")
    assert err.count("\n") == 1
    assert sentence in err
    assert not (tmp_path / "r").exists()


@pytest.mark.parametrize("place", ["file", "file/r"])
def test_a_file_in_the_place_of_a_folder(cosim, tmp_path, place):
    (tmp_path / "file").write_text("kept")
    code, _, err = cosim("run", "tanks", "-o", str(tmp_path / place))
    where = f"cannot write into {tmp_path / place}"
    assert (code, err) == (2, f"cosim: {where}: there is a file in the place of a folder; give another one (-o)\n")
    assert (tmp_path / "file").read_text() == "kept"


def test_what_cannot_be_set_is_told_before_anything_is_built(cosim, monkeypatch, tmp_path):
    """A model whose declaration is known needs no .fmu file for that."""
    monkeypatch.setattr("fmus.supply.cached", lambda _component: pytest.fail("it is built"))
    for option, value, sentence in (
        ("--set", "llc.suspension.enabld=1", "unknown variable of llc (LowLevelPid) 'suspension.enabld'; did you mean"),
        ("--set", "plant.body.mass=-1", "plant.body.mass = -1 kg is outside its range"),
        ("--at", "1:plant.body_frce.y=1", "unknown input of plant (Vehicle16Dof) 'body_frce.y'; did you mean"),
        ("--at", "1:plant.body_force.y=x", "plant.body_force.y = x is not a number"),
    ):
        code, _, err = cosim("run", "lateral-tracking", option, value, "-o", str(tmp_path / "r"))
        assert (code, err.count("\n")) == (2, 1)
        assert sentence in err


def test_no_choice_is_cut_from_the_list(cosim, monkeypatch):
    for width in ("60", "80", "120"):
        monkeypatch.setenv("COLUMNS", width)
        assert "…" not in cosim("list")[1]


def test_the_picture_is_drawn_while_the_folder_is_held(cosim, monkeypatch, tmp_path):
    seen = []

    def draw(finished, file):
        with pytest.raises(CosimError, match="another run is writing"), claimed(file.parent):
            pass
        seen.append(file.name)

    monkeypatch.setattr("cosim.run.running.Finished.draw", draw)
    assert cosim("run", "tanks", "-o", str(tmp_path), "--quiet")[0] == 0
    assert seen == ["overview.png"]


def test_a_discard_keeps_the_results_so_far(cosim, tmp_path):
    code, _, err = cosim("run", "tanks", "-o", str(tmp_path), "--set", "second.fail_at=0.5", "--no-report")
    assert code == 1
    assert err == (
        "cosim: second failed at 0.5 s (discard): the tank leaks 100%s of its water; the results so far are kept\n"
    )
    assert json.loads((tmp_path / "summary.json").read_text())["status"] == "failed"
    assert load_results(tmp_path, Facts({})).time[-1] == 0.5


def spoil(tank: Path, target: Path, change) -> None:
    """A copy of the FMU with its entries as `change` gives them: {name: bytes} -> {name: bytes}."""
    with zipfile.ZipFile(tank) as source:
        entries = {name: source.read(name) for name in source.namelist() if not name.endswith("/")}
    with zipfile.ZipFile(target, "w") as sink:
        for name, data in change(entries).items():
            sink.writestr(name, data)


def _edit(old, new):
    def change(entries):
        xml = entries["modelDescription.xml"]
        assert old in xml
        return entries | {"modelDescription.xml": xml.replace(old, new, 1)}

    return change


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda e: {n: d for n, d in e.items() if n != "modelDescription.xml"}, "has no modelDescription.xml"),
        (lambda e: {n: d for n, d in e.items() if not n.startswith("binaries/")}, "has no binary for"),
        (lambda e: e | {"../escape.txt": b"x"}, "leads out of the archive"),
        (lambda e: e | {"/etc/escape": b"x"}, "leads out of the archive"),
        (lambda e: e | {"modelDescription.xml": b"<fmiModelDescription"}, "invalid modelDescription.xml"),
        (_edit(b'fmiVersion="2.0"', b'fmiVersion="3.0"'), "invalid modelDescription.xml"),
        (lambda e: {n: d for n, d in e.items() if "slavemodule" not in n}, "there is no resources/slavemodule.txt"),
        (lambda e: {n: d[:9999] if n.endswith(".so") else d for n, d in e.items()}, "CosimTestTank.so has 9999 bytes"),
        (lambda e: {n: b"" if n.endswith(".so") else d for n, d in e.items()}, "CosimTestTank"),
        (_edit(b"?>", b'?><!DOCTYPE a [<!ENTITY x SYSTEM "file:///etc/passwd">]>'), "declares a document type"),
    ],
)
def test_foreign_and_corrupt_fmus(cosim, tank, tmp_path, change, sentence):
    spoil(tank, tmp_path / "bad.fmu", change)
    code, out, err = cosim("run", "tanks", "-o", str(tmp_path / "r"), "--set", "scenario.source=bad")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert sentence in err
    assert not list(tmp_path.parent.glob("escape*"))


def test_a_file_that_is_no_archive(cosim, tmp_path):
    (tmp_path / "bad.fmu").write_bytes(b"not a zip file")
    code, _, err = cosim("run", "tanks", "-o", str(tmp_path / "r"), "--set", "scenario.source=bad")
    assert (code, err.count("\n")) == (2, 1)
    assert "is not a readable zip archive" in err


def test_list_names_every_scenario_and_its_figures(cosim):
    code, out, _ = cosim("list")
    assert code == 0
    listed = json.loads(cosim("list", "--json")[1])
    assert {"high-speed-tracking", "lateral-tracking", "longitudinal-tracking"} <= {entry["name"] for entry in listed}
    assert all(entry["name"] in out and entry["figures"] for entry in listed)


def test_metrics_that_fail_leave_results_and_a_summary_that_says_so(cosim, tanks, tank, offer, tmp_path):
    for wrong, sentence in (
        (lambda results, _: {"ratio": Metric(1.0 / 0.0)}, "ZeroDivisionError: float division by zero"),
        (lambda results, _: {"level": Metric(results["third.level"][-1])}, "unknown signal 'third.level'"),
    ):
        offer(tanks(metrics=wrong), {"Tank": tank})
        code, _, err = cosim("run", "tanks", "-o", str(tmp_path), "--no-report")
        assert (code, err.count("\n")) == (1, 1), err
        assert f"the metrics cannot be computed: {sentence}" in err
        assert json.loads((tmp_path / "summary.json").read_text())["status"] == "failed"
        assert len(load_results(tmp_path).time) == 101
