"""Logs of measured columns: fed to a small C FMU and held against what it should give."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from small_c import foreign, variable

from cosim.command.main import main
from cosim.errors import CosimError
from cosim.replay.running import Replayed, replay

UNITS = '<Unit name="deg/s"><BaseUnit rad="1" s="-1" factor="0.017453292519943295"/></Unit>'
UNITS += '<Unit name="m"><BaseUnit m="1"/></Unit>'
LATE = 0.08
"""[s] The logged output comes so much before that of the FMU, which shows what it took a step ago."""
MAP = """
model = "sensor.fmu"
period = 0.01
header_lines = 2
time = {column = "t", unit = "ms"}

[inputs]
"sensor.rate" = {column = "yaw rate", unit = "rad/s", factor = -1.0}

[compare]
"sensor.shown" = {column = "seen", unit = "rad/s", factor = -1.0}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An FMU that shows its input, a rate in deg/s, and a log of a sine with holes, a row twice and names in quotes."""
    ports = [variable("rate", 0, "input", start="0", unit="deg/s"), variable("shown", 1, "output", unit="deg/s")]
    ports += [variable(name, k, "input", start="0", unit="m") for name, k in (("x", 2), ("y", 3))]
    ports += [variable(f"a.{axis}", 4 + k, "input", start="0") for k, axis in enumerate("xyz")]
    foreign(tmp_path / "sensor.fmu", ports, {"fmi2DoStep": "m->r[1] = m->r[0];"}, units=UNITS)
    lines = ['# "t","yaw rate","seen","note"', '# "ms","rad/s","rad/s",""']
    for k in range(600):
        t = 0.01 * k
        hole = "" if k % 97 == 5 else f"{-math.sin(2 * t):.9f}"
        lines += [f"{1000 * t + 5000:.3f},{hole},{-math.sin(2 * (t + LATE)):.9f},text"]
    lines.insert(100, lines[99])
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    return tmp_path


def replayed(folder: Path, text: str) -> Replayed:
    (folder / "map.toml").write_text(text)
    return replay(folder / "log.csv", folder / "map.toml", folder / "out")


def test_a_column_feeds_an_input_in_its_unit(folder: Path) -> None:
    """The rate arrives in deg/s, holes are bridged on straight lines, and the lag is found."""
    found = replayed(folder, MAP)
    results = found.finished.results
    assert results.time[-1] == pytest.approx(5.99)
    taken = results["sensor.rate"][:-1]
    np.testing.assert_allclose(taken, np.degrees(np.sin(2 * results.time[:-1])), atol=np.degrees(2e-4))
    (error,) = found.errors
    # what is shown at t is what was taken 0.01 s before
    assert error.lag == pytest.approx(LATE + 0.01, abs=2e-4)
    expected = math.degrees(2 * math.sin(LATE + 0.01)) / math.sqrt(2)
    assert error.rms == pytest.approx(expected, rel=0.03) and error.rms_at_lag < 0.02
    assert error.reach == pytest.approx(math.degrees(2.0), rel=1e-3) and error.unit == "deg/s"


def test_latitude_and_longitude(folder: Path) -> None:
    """At 47 degrees north: 0.001 degrees are 111.17 m to the north and 76.06 m to the east (radii of WGS 84)."""
    rows = ["t,lat,lon"] + [f"{0.1 * k},{47 + 1e-4 * k},{19 + 1e-4 * k}" for k in range(11)]
    (folder / "log.csv").write_text("\n".join(rows))
    text = 'model = "sensor.fmu"\nperiod = 0.1\ntime = {column = "t"}\n[[positions]]\n'
    text += 'latitude = "lat"\nlongitude = "lon"\n'
    results = replayed(folder, text + 'x = "sensor.x"\ny = "sensor.y"\n').finished.results
    flattening, major = 1 / 298.257223563, 6378137.0
    squared, sine = flattening * (2 - flattening), math.sin(math.radians(47.0005))
    across = major / math.sqrt(1 - squared * sine**2)
    along = major * (1 - squared) / (1 - squared * sine**2) ** 1.5
    assert results["sensor.y"][-2] == pytest.approx(9e-4 * math.radians(1) * along, rel=1e-5)
    east = 9e-4 * math.radians(1) * across * math.cos(math.radians(47.00045))
    assert results["sensor.x"][-2] == pytest.approx(east, rel=1e-4)


def test_a_sensor_that_is_mounted_turned(folder: Path) -> None:
    """Turned by 90 degrees to the left its x is the car's y; rolled by 90 degrees its y is then the car's z."""
    (folder / "log.csv").write_text("t,ax,ay,az\n0,1,2,3\n1,1,2,3\n")
    text = 'model = "sensor.fmu"\nperiod = 0.1\ntime = {column = "t"}\n[[vectors]]\nport = "sensor.a"\n'
    text += 'columns = ["ax", "ay", "az"]\nyaw = 90.0\nroll = 90.0\n'
    results = replayed(folder, text).finished.results
    car = [results[f"sensor.a.{axis}"][3] for axis in "xyz"]
    assert car == pytest.approx([3.0, 1.0, 2.0])  # z of the sensor, turned by roll, points along the car's x


def test_mdf_gives_what_csv_gives(folder: Path) -> None:
    mdf = pytest.importorskip("asammdf")
    time = 0.01 * np.arange(600)
    with mdf.MDF(version="4.10") as made:
        made.append([mdf.Signal(np.sin(time), time, name="yaw rate")])
        made.save(folder / "log.mf4")
    text = 'model = "sensor.fmu"\nperiod = 0.01\ntime = {column = "time"}\n[inputs]\n'
    (folder / "map.toml").write_text(text + '"sensor.rate" = {column = "yaw rate", unit = "rad/s"}\n')
    results = replay(folder / "log.mf4", folder / "map.toml", folder / "out").finished.results
    np.testing.assert_allclose(results["sensor.rate"][:-1], np.degrees(np.sin(results.time[:-1])), atol=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('"yaw rate"', '"yaw_rate"', r"unknown column of .*log\.csv 'yaw_rate'.*yaw rate"),
        ('"sensor.rate"', '"sensor.raet"', "unknown input of sensor .*raet"),
        ('"sensor.shown"', '"sensor.rate"', "unknown output of sensor"),
        ('unit = "ms"', 'unit = "jots"', "unknown unit 'jots'"),
        ('column = "t"', 'column = "seen"', "the time in seen does not increase"),
        ('model = "sensor.fmu"', "", "give either a system or a model"),
        ('model = "sensor.fmu"', 'model = "none.fmu"', r"none\.fmu"),
        ("header_lines = 2", "header_lines = 9999", "has no rows after its names"),
        ("header_lines", "headerlines", "unknown key `headerlines`"),
        ('{column = "yaw rate", unit', '{column = "note", unit', "note holds no numbers"),
    ],
)
def test_mistakes(folder: Path, old: str, new: str, sentence: str) -> None:
    assert old in MAP
    with pytest.raises(CosimError, match=sentence):
        replayed(folder, MAP.replace(old, new, 1))
    assert not (folder / "out").exists()


def test_the_command(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "map.toml").write_text(MAP)
    out = folder / "out"
    words = ["replay", folder / "log.csv", "--map", folder / "map.toml", "-o", out]
    monkeypatch.setattr(sys, "argv", ["cosim", *map(str, words)])
    with pytest.raises(SystemExit) as left:
        main()
    assert not left.value.code
    shown = capsys.readouterr().out
    assert "sensor.shown" in shown and "90." in shown and "ms" in shown
    assert (out / "replay.png").stat().st_size > 5000 and "rms_at_lag" in (out / "replay.json").read_text()
