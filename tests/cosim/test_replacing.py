"""A user's FMU in an instance's place: what fits is wired, what does not is said, and values come from files."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from cosim_mocks import scenario_of
from small_c import foreign, variable

from cosim.command.options import assigned, replacements
from cosim.errors import CosimError
from cosim.model.system import System
from cosim.run.request import Request
from cosim.run.running import Finished, run
from cosim.scenario.limit import Limit
from cosim.scenario.metric import Metric

GAIN = variable("gain", 4, "parameter", variability="fixed", start="1")
STEP = {"fmi2DoStep": "m->r[1] = m->r[4] * m->r[0]; m->r[3] = m->r[2];"}


def output(name: str, reference: int) -> str:
    return variable(name, reference, "output", variability="discrete")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A source of 2, an amplifier of two channels and a variant of it, and a meter of both."""
    foreign(tmp_path / "source.fmu", [output("y", 0), output("z", 1)], {"fmi2DoStep": "m->r[0] = 2; m->r[1] = 3;"})
    pair = [variable("a", 0, "input", start="0"), variable("b", 2, "input", start="0")]
    foreign(tmp_path / "amplifier.fmu", [*pair, output("p", 1), output("q", 3), GAIN], STEP)
    extra = variable("c", 5, "input", start="0")
    other = {"fmi2DoStep": "m->r[1] = 100 * m->r[0] + m->r[5];"}
    foreign(tmp_path / "mine.fmu", [pair[0], extra, output("p", 1)], other, experiment="")
    meter = [variable(name, k, "input", start="0") for k, name in enumerate("pq")]
    foreign(tmp_path / "meter.fmu", [*meter, output("sum", 2)], {"fmi2DoStep": "m->r[2] = m->r[0] + 10 * m->r[1];"})
    return tmp_path


def ran(folder: Path, *asked: tuple[str, Path], texts: tuple[str, ...] = ()) -> Finished:
    def build(_settings: object, _prepared: object) -> System:
        system = System()
        system.add("source", str(folder / "source.fmu"), period=0.1, kind="sampled")
        system.add("amplifier", str(folder / "amplifier.fmu"), {"gain": 5.0}, period=0.1, kind="sampled")
        system.add("meter", str(folder / "meter.fmu"), period=0.1, kind="sampled")
        system.connect("source", "amplifier", {"a": "y", "b": "z"})
        system.connect("amplifier", "meter")
        return system

    def metrics(results: object, _prepared: object) -> dict[str, Metric]:
        return {"q": Metric(float(results["amplifier.q"][-1])), "gain": Metric(results.number("amplifier", "gain"))}

    scenario = scenario_of(
        "amplified", build, stop_time=0.5, metrics=metrics, limits=(Limit("q is too large", "q", most=10.0),)
    )
    values = assigned(list(texts), None)
    return run(Request(scenario, folder / "out", values, replacements=list(asked)))


def test_what_fits_is_wired_and_what_does_not_is_told(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    """mine = 100 a; the meter's q is fed no more; the scenario's gain, which has no place, can still be asked."""
    assert ran(folder).results["meter.sum"][1:-1] == pytest.approx(5 * 2 + 10 * 3)
    caplog.clear()
    finished = ran(folder, ("amplifier", folder / "mine.fmu"))
    np.testing.assert_array_equal(finished.results["meter.sum"][1:-1], 100 * 2)
    assert caplog.messages == [
        "mine.fmu in the place of amplifier does not read b",
        "mine.fmu in the place of amplifier has no output for meter.q: such inputs keep their start values",
        "mine.fmu in the place of amplifier has inputs that nothing feeds: c",
        "mine.fmu in the place of amplifier has no place for the values of gain",
    ]
    metrics = finished.summary.metrics
    assert math.isnan(metrics["q"].value) and metrics["gain"].value == 5.0
    assert finished.summary.status == "ok"
    assert finished.plan.nodes["amplifier"].kind == "sampled" and finished.plan.nodes["amplifier"].period == 100_000_000


def test_its_own_values_can_be_set(folder: Path) -> None:
    results = ran(folder, ("ampl*", folder / "mine.fmu"), texts=("amplifier.c=9",)).results
    assert results["meter.sum"][1:-1] == pytest.approx(209.0)


@pytest.mark.parametrize(
    ("asked", "texts", "sentence"),
    [
        ("amplifyer=mine.fmu", (), "unknown instance .*amplifyer.*amplifier"),
        ("amplifier=none.fmu", (), r"none\.fmu cannot take the place of amplifier: give the path"),
        ("amplifier=", (), "write --replace INSTANCE=FILE"),
        ("amplifier=mine.fmu", ("amplifier.gain=2",), "unknown variable of amplifier .*gain"),
        ("amplifier=mine.fmu", ("source.y=2",), r"source\.y is an output"),
    ],
)
def test_mistakes(folder: Path, asked: str, texts: tuple[str, ...], sentence: str) -> None:
    with pytest.raises(CosimError, match=sentence):
        ran(folder, *((name, folder / file) for name, file in replacements([asked])), texts=texts)
    assert not (folder / "out").exists()


def test_values_from_files(tmp_path: Path) -> None:
    file = tmp_path / "values.toml"
    file.write_text('"b.x" = 1\n[a]\ny = 2.5\nz = true\n[a.deep]\nname = "text"\n')
    assert assigned(["a.y=3"], [file]) == [
        ("b.x", "1"), ("a.y", "2.5"), ("a.z", "true"), ("a.deep.name", "text"), ("a.y", "3")
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x = 1", "x belongs to no instance"),
        ("[a]\nx = [1]", r"a\.x is \[1\]; give a number"),
        ("[a\n", "is no TOML"),
        (None, "cannot be read"),
    ],
)
def test_files_that_are_wrong(tmp_path: Path, text: str | None, sentence: str) -> None:
    file = tmp_path / "values.toml"
    if text is not None:
        file.write_text(text)
    with pytest.raises(CosimError, match=sentence):
        assigned(None, [file])
