"""FMUs of other tools: what their descriptions say is kept, and they are called as FMI 2.0 allows."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest
from cosim_mocks import scenario_of
from small_c import foreign, variable

from cosim.errors import CosimError
from cosim.model.system import System
from cosim.run.request import Request
from cosim.run.running import Finished, run

KELVIN = '<Unit name="K"><BaseUnit K="1"/></Unit><Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>'
Y = variable("y", 0, "output")
N = variable("n", 0, "parameter", "Integer", variability="fixed", start="0")


def ran(system: System, folder: Path, stop: float = 0.5, **options: str) -> Finished:
    scenario = scenario_of("foreign", lambda _settings, _prepared: system, stop_time=stop)
    return run(Request(scenario, folder, **options))


def alone(file: Path, folder: Path, stop: float = 0.5, **options: object) -> Finished:
    system = System()
    system.add("a", str(file), **options)
    return ran(system, folder, stop)


def heated(tmp_path: Path, source: str, target: str) -> float:
    """5 of `source`'s unit as what a consumer with `target`'s unit reads."""
    relative = {"degC": {"unit": "degC"}, "K": {"unit": "K"}}
    out, into = (
        relative[text.split()[0]] | ({"relativeQuantity": "true"} if "rise" in text else {})
        for text in (source, target)
    )
    five = {"fmi2GetReal": "v[0] = 5.0;"}
    giver = foreign(tmp_path / "giver.fmu", [variable("t", 0, "output", **out)], five, units=KELVIN)
    through = {"fmi2DoStep": "m->r[1] = m->r[0];"}
    ports = [variable("t", 0, "input", start="0", **into), variable("y", 1, "output")]
    taker = foreign(tmp_path / "taker.fmu", ports, through, units=KELVIN)
    system = System()
    system.add("giver", str(giver))
    system.add("taker", str(taker))
    system.connect("giver", "taker")
    return float(ran(system, tmp_path / "out").results["taker.y"][-1])


def test_differences_have_no_offset(tmp_path):
    assert heated(tmp_path, "degC", "K") == pytest.approx(278.15)
    assert heated(tmp_path, "degC rise", "K rise") == 5.0
    assert heated(tmp_path, "K rise", "degC rise") == 5.0


@pytest.mark.parametrize(("source", "target"), [("degC rise", "K"), ("K", "degC rise")])
def test_a_difference_is_no_value(tmp_path, source, target):
    with pytest.raises(CosimError, match=r"giver\.t -> taker\.t: a (difference|value) in .* cannot become"):
        heated(tmp_path, source, target)


def test_one_instance_per_process_means_one(tmp_path):
    file = foreign(tmp_path / "f.fmu", [Y], flags='canBeInstantiatedOnlyOncePerProcess="true"')
    system = System()
    system.add("a", str(file))
    assert ran(system, tmp_path / "one").summary.status == "ok"
    system.add("b", str(file))
    with pytest.raises(CosimError, match=r"only once per process, but a and b are both instances"):
        ran(system, tmp_path / "two")


def test_a_plant_may_have_discrete_outputs(tmp_path, caplog):
    """Said to be a plant, its outputs belong to the end of its steps: y(t) = t."""
    y = variable("y", 0, "output", variability="discrete")
    file = foreign(tmp_path / "f.fmu", [y], {"fmi2DoStep": "m->r[0] += h;"})
    results = alone(file, tmp_path / "out", kind="continuous").results
    assert results["a.y"] == pytest.approx(results.time)
    assert not caplog.messages
    alone(file, tmp_path / "guessed")
    assert caplog.messages == [
        "a: all its outputs are discrete, so it runs as a controller, whose outputs belong to the start of a step; "
        'if it is a plant, say so: System.add(..., kind="continuous")'
    ]


def note(log: Path, name: str) -> str:
    return f'FILE *file = fopen("{log}", "a"); fprintf(file, "{name} %s\\n", m->name); fclose(file);'


@pytest.mark.parametrize(
    ("call", "status", "after"),
    [
        ("fmi2DoStep", 2, ["terminate b", "free b", "terminate a", "free a"]),
        ("fmi2DoStep", 3, ["terminate b", "free b", "free a"]),
        ("fmi2DoStep", 4, []),
        ("fmi2GetReal", 4, []),
        ("fmi2SetReal", 3, ["terminate b", "free b", "free a"]),
        ("fmi2ExitInitializationMode", 3, ["free b", "free a"]),
        ("fmi2ExitInitializationMode", 4, []),
        ("fmi2EnterInitializationMode", 3, ["free b", "free a"]),
    ],
)
def test_what_may_be_called_after_a_failure(tmp_path, call, status, after):
    """FMI 2.0.4, 2.1.3 and 4.2.4: nothing of an FMU after fatal, no terminate after an error or too early."""
    log = tmp_path / "calls.txt"
    log.touch()
    fails = f"if (m->name[0] == 'a' && m->steps++ >= {5 if call[4] in 'DGS' else 0}) return {status};"
    calls = {call: fails, "fmi2Terminate": note(log, "terminate"), "fmi2FreeInstance": note(log, "free")}
    file = foreign(tmp_path / "f.fmu", [variable("u", 1, "input", start="0"), Y], calls)
    system = System()
    for name in "ab":
        system.add(name, str(file))
    system.connect("a", "b", {"u": "y"})
    system.connect("b", "a", {"u": "y"})
    finished = ran(system, tmp_path / "out", 2.0)
    assert finished.summary.status == "failed"
    assert finished.summary.reason.startswith("a failed at ")
    assert log.read_text().splitlines() == after


def test_a_step_is_not_cut_short_of_whole_steps(tmp_path):
    file = foreign(tmp_path / "f.fmu", [Y], {"fmi2DoStep": "if (h < 0.0999) return 3;"}, flags="")
    assert alone(file, tmp_path / "out", 0.5).summary.status == "ok"
    with pytest.raises(
        CosimError, match=r"within a step of a, .* only whole steps of 0\.1 s; end it at 0\.4 or 0\.5 s"
    ):
        alone(file, tmp_path / "out", 0.45)


def test_a_start_other_than_zero_is_told(tmp_path, caplog):
    file = foreign(tmp_path / "f.fmu", [Y], experiment='<DefaultExperiment startTime="10" stepSize="0.1"/>')
    alone(file, tmp_path / "out")
    assert caplog.messages == ["a: its default experiment starts at 10 s; runs start at 0 s"]


def test_a_step_of_no_whole_nanoseconds_has_a_remedy(tmp_path):
    file = foreign(tmp_path / "f.fmu", [Y], experiment=f'<DefaultExperiment stepSize="{1 / 60}"/>')
    with pytest.raises(CosimError, match=r"the period of a .* whole number of nanoseconds; take 0\.016666667 s"):
        alone(file, tmp_path / "out")
    assert alone(file, tmp_path / "out", period=0.016666667).summary.status == "ok"


def renamed(file: Path, made: Path, old: str, new: str) -> Path:
    with zipfile.ZipFile(file) as source, zipfile.ZipFile(made, "w") as target:
        for name in source.namelist():
            target.writestr(name.replace(old, new), source.read(name))
    return made


def test_sentences_say_what_failed(tmp_path):
    file = foreign(tmp_path / "f.fmu", [Y, N])
    other = renamed(file, tmp_path / "other.fmu", "foreign.so", "library.so")
    with pytest.raises(CosimError, match=r"has library\.so for linux64, but its modelIdentifier asks for foreign\.so"):
        alone(other, tmp_path / "out")
    back = renamed(file, tmp_path / "back.fmu", "/", "\\")
    with pytest.raises(CosimError, match=r"with a backslash; .* pack it again"):
        alone(back, tmp_path / "out")


def test_an_fmu_may_end_the_simulation(tmp_path):
    """A discarded step with the status fmi2Terminated is a regular end (FMI 2.0.4, 4.2.3)."""
    calls = {"fmi2DoStep": "if (++m->steps == 4) return 2; m->r[0] = t + h;", "fmi2GetBooleanStatus": "*v = k == 3;"}
    finished = alone(foreign(tmp_path / "f.fmu", [Y], calls), tmp_path / "out", 2.0)
    assert (finished.summary.status, finished.summary.reason) == ("ok", "a ended the simulation at 0.3 s")
    assert finished.results.time.tolist() == [0.0, 0.1, 0.2, 0.3]
    assert finished.results["a.y"] == pytest.approx([0.0, 0.1, 0.2, 0.3])


@pytest.mark.parametrize("kind", ["continuous", "sampled"])
def test_outputs_of_every_type_are_recorded(tmp_path, kind):
    """In the type they have; of a plant at the end of its step, of a controller at its beginning."""
    items = "".join(f'<Item name="{name}" value="{k}"/>' for k, name in enumerate(("neutral", "first", "second")))
    gears = f'<SimpleType name="gear"><Enumeration>{items}</Enumeration></SimpleType>'
    discrete = {"variability": "discrete"}
    ports = [
        variable("word", 0, "output", "String", **discrete),
        variable("on", 2, "output", "Boolean", **discrete),
        variable("gear", 1, "output", "Enumeration", declaredType="gear", **discrete),
        Y,
        variable("n", 0, "output", "Integer", **discrete),
    ]
    step = "m->r[0] += h; m->i[0] -= 2; m->i[1] = 1 + m->i[0] % 4 / -2; m->i[2] = !m->i[2];"
    word = 'static char text[2][9]; static int k; k = !k; snprintf(text[k], 9, "n%d", m->i[0]); v[0] = text[k];'
    file = foreign(tmp_path / "f.fmu", ports, {"fmi2DoStep": step, "fmi2GetString": word}, types=gears)
    results = alone(file, tmp_path / "out", 0.3, kind=kind).results
    steps = {"continuous": [0, 1, 2, 3], "sampled": [1, 2, 3, 3]}[kind]
    assert results["a.n"].tolist() == [-2 * k for k in steps]
    assert results["a.word"].tolist() == [f"n{-2 * k}" for k in steps]
    assert results["a.on"].tolist() == [k % 2 == 1 for k in steps]
    assert results["a.gear"].tolist() == [0 if k == 0 else 1 + k % 2 for k in steps]
    assert results["a.y"] == pytest.approx([0.1 * k for k in steps])
    assert [results[f"a.{name}"].dtype for name in ("n", "gear", "on")] == ["int32", "int32", "bool"]
