"""system.toml: two tanks of small C FMUs described in a file, and every mistake such a file can have."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small_c import foreign, variable

from cosim.command.opening import opened
from cosim.errors import CosimError
from cosim.run.request import Request
from cosim.run.running import Finished, run

GOOD = """
title = "Water runs from tank to tank"
stop_time = 1.0

[instances.tank1]
model = "tank.fmu"
period = 0.1
parameters = {initial = 8, rate = 0.5}

[instances.tank2]
model = "tank.fmu"
period = 0.1

[instances.meter1]
model = "meter.fmu"
period = 0.1
kind = "sampled"

[instances.meter2]
model = "meter.fmu"
period = 0.1
kind = "sampled"

[[connections]]
from = "tank1"
to = "tank2"
names = {inflow = "outflow"}

[[connections]]
from = "tank*"
to = "meter*"
names = {u = "level"}

[[events]]
time = 0.5
set = {"tank1.inflow" = 4.0}

[metrics.level_end]
signal = "tank2.level"
of = "last"

[metrics.difference]
signal = "tank1.level"
minus = "tank2.level"
of = "largest"
after = 0.2
at_most = 3.0
words = "the tanks differ too much"
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Euler steps of level' = inflow - rate level, and a meter that shows what it takes."""
    tank = [
        variable("level", 0, "output"),
        variable("outflow", 1, "output"),
        variable("inflow", 2, "input", start="0"),
        variable("rate", 3, "parameter", variability="fixed", start="0"),
        variable("initial", 4, "parameter", variability="fixed", start="0"),
    ]
    step = "m->r[0] += h * (m->r[2] - m->r[3] * m->r[0]); m->r[1] = m->r[3] * m->r[0];"
    calls = {"fmi2DoStep": step, "fmi2ExitInitializationMode": "m->r[0] = m->r[4]; m->r[1] = m->r[3] * m->r[0];"}
    foreign(tmp_path / "tank.fmu", tank, calls)
    meter = [variable("u", 0, "input", start="0"), variable("y", 1, "output", variability="discrete")]
    foreign(tmp_path / "meter.fmu", meter, {"fmi2DoStep": "m->r[1] = m->r[0];"})
    return tmp_path


def ran(folder: Path, text: str) -> Finished:
    (folder / "system.toml").write_text(text)
    with opened(str(folder / "system.toml")) as scenario:
        return run(Request(scenario, folder / "out"))


def test_a_file_runs(folder: Path) -> None:
    """Against the same Euler steps in NumPy; a start value given as a whole number is a Real."""
    finished = ran(folder, GOOD)
    results = finished.results
    first, second, outflow = 8.0, 0.0, 4.0
    for k, time in enumerate(results.time):
        assert (results["tank1.level"][k], results["tank2.level"][k]) == pytest.approx((first, second))
        second += 0.1 * outflow
        first += 0.1 * ((4.0 if time >= 0.5 - 1e-9 else 0.0) - 0.5 * first)
        outflow = 0.5 * first
    np.testing.assert_array_equal(results["meter1.y"][1:-1], results["tank1.level"][1:-1])
    np.testing.assert_array_equal(results["meter2.y"][1:-1], results["tank2.level"][1:-1])
    metrics = finished.summary.metrics
    assert metrics["level_end"].value == results["tank2.level"][-1]
    late = results.time >= 0.2
    apart = np.abs(results["tank1.level"] - results["tank2.level"])[late].max()
    assert metrics["difference"].value == apart
    assert (finished.summary.status == "missed") == (apart > 3.0)


def test_factors_and_maps(folder: Path) -> None:
    text = GOOD[: GOOD.index("[[connections]]")] + '[[connections]]\nfrom = "tank1.level"\nto = "meter1.u"\n'
    finished = ran(folder, text + "factor = -2.0\noffset = 1.0\n")
    levels = finished.results["tank1.level"][1:-1]
    np.testing.assert_allclose(finished.results["meter1.y"][1:-1], 1.0 - 2.0 * levels, rtol=1e-15)


def test_a_factor_of_one_keeps_units_from_being_converted(tmp_path: Path) -> None:
    """And what a partial map does not name stays."""
    giver = foreign(
        tmp_path / "mm.fmu", [variable("y", 0, "output", unit="mm")], {"fmi2DoStep": "m->r[0] = 5.0;"}, units=MM
    )
    ports = [variable("u", 0, "input", unit="m", start="0"), variable("y", 1, "output", unit="m")]
    foreign(tmp_path / "m.fmu", ports, {"fmi2DoStep": "m->r[1] = m->r[0];"}, units=MM)
    text = """
    stop_time = 0.4
    instances = {a = {model = "mm.fmu"}, b = {model = "m.fmu"}, c = {model = "m.fmu"}, d = {model = "m.fmu"}}
    connections = [
        {from = "a.y", to = "b.u"},
        {from = "a.y", to = "c.u", factor = 1.0},
        {from = "a.y", to = "d.u", map = {4 = 7}, partial = true},
    ]
    """
    (tmp_path / "system.toml").write_text(text)
    with opened(str(tmp_path / "system.toml")) as scenario:
        results = run(Request(scenario, tmp_path / "out")).results
    assert [results[f"{name}.y"][-1] for name in "bcd"] == [0.005, 5.0, 5.0]
    assert giver.is_file()


MM = '<Unit name="m"><BaseUnit m="1"/></Unit><Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>'


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("stop_time = 1.0", "stop_tim = 1.0", r"unknown key `stop_tim`"),
        ("stop_time = 1.0", "", r"no `stop_time`"),
        ("stop_time = 1.0", 'stop_time = "1 s"', r"expected `float`, got `str`, in stop_time"),
        ("stop_time = 1.0", "stop_time = -1.0", r"the stop time is -1 s; it must be positive"),
        ("period = 0.1\nparam", "periode = 0.1\nparam", r"unknown key `periode`, in instances"),
        ("period = 0.1\nparam", "period = 0.0\nparam", r"the period of tank1 .* is 0 s"),
        ('kind = "sampled"', 'kind = "samplet"', r"invalid enum value 'samplet', in instances"),
        ("rate = 0.5", "rat = 0.5", r"unknown variable of tank1 .*rat.*rate"),
        ("rate = 0.5", 'rate = "fast"', r"tank1\.rate = fast is not a number"),
        ('"tank.fmu"', '"tanc.fmu"', r"tanc\.fmu"),
        ('from = "tank1"', 'from = "tank3"', r"unknown instance .*tank3"),
        ('to = "meter*"', 'to = "metre*"', r"connection 2: no instance fits the pattern 'metre\*'"),
        ('names = {inflow = "outflow"}', 'names = {inflow = "outflov"}', r"unknown output of tank1 .*outflov"),
        ('names = {inflow = "outflow"}', "factor = 2.0", r"connection 1: factor, offset and map need signals"),
        ('to = "tank2"', 'to = "tank2.inflow"', r"connection 1: names need instances"),
        ('"tank1.inflow"', '"tank2.inflow"', r"tank2\.inflow cannot be set, as it is connected"),
        ("time = 0.5", "time = -0.5", r"cannot be set at -0\.5 s"),
        ('of = "last"', 'of = "median"', r"invalid enum value 'median', in metrics"),
        ('"tank2.level"\nof', '"tank2.depth"\nof', r"unknown output of tank2 .*depth.*level"),
        ("at_most = 3.0", "at_most = nan", r"metric difference: after, at_most and at_least must be numbers"),
        ('signal = "tank2.level"', 'signal = "tank2.rate"', r"unknown output of tank2 .* that is a number"),
        ("stop_time = 1.0", "stop_time = ", r"is no TOML: .*line 3"),
        ("[instances.tank2]", "[instances.tank1]", r"is no TOML: .*tank1"),
    ],
)
def test_mistakes(folder: Path, old: str, new: str, sentence: str) -> None:
    """One sentence each, before anything runs."""
    assert old in GOOD
    with pytest.raises(CosimError, match=sentence) as caught:
        ran(folder, GOOD.replace(old, new, 1))
    assert "\n" not in str(caught.value)
    assert not (folder / "out").exists()


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(CosimError, match=r"none\.toml cannot be read: No such file"), opened(f"{tmp_path}/none.toml"):
        pass
