"""Results for other programs, read back by other means, and two runs held against each other."""

from __future__ import annotations

import csv
import math
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from scipy.io import loadmat

from cosim.command.main import main
from cosim.errors import CosimError
from cosim.results.comparing import compare
from cosim.results.converting import convert
from cosim.results.reading import Results, load_results
from cosim.results.selection import rows, signals

TIME = np.arange(0, 1.0001, 0.1)


def folder_of(folder: Path, shift: float = 0.0, time: np.ndarray = TIME, **more: np.ndarray) -> Path:
    """A run of a car and a counter."""
    columns = {
        "time": (time, "s"),
        "car.x": (10.0 * time + shift, "m"),
        "car.yaw": (np.sin(time), "rad"),
        "counter.n": (np.arange(len(time)), ""),
    } | {name: (values, "") for name, values in more.items()}
    fields = [
        pa.field(name, pa.array(values).type, metadata={"unit": unit}) for name, (values, unit) in columns.items()
    ]
    folder.mkdir()
    table = pa.table([pa.array(values) for values, _ in columns.values()], schema=pa.schema(fields))
    parquet.write_table(table, folder / "results.parquet")
    return folder


@pytest.fixture
def results(tmp_path: Path) -> Results:
    return load_results(folder_of(tmp_path / "run"))


def test_csv(results: Results, tmp_path: Path) -> None:
    with convert(results, tmp_path / "r.csv").open(newline="") as file:
        header, *lines = csv.reader(file)
    assert header == ["time", "car.x", "car.yaw", "counter.n"]
    read = np.array(lines, float)
    np.testing.assert_array_equal(read[:, 2], results["car.yaw"])  # shortest text that is the same double
    np.testing.assert_array_equal(read[:, 0], TIME)


def test_mat(results: Results, tmp_path: Path) -> None:
    read = loadmat(convert(results, tmp_path / "r.mat", ["car.*"]), simplify_cells=True)
    assert list(read["names"]) == ["car.x", "car.yaw"] and list(read["units"]) == ["m", "rad"]
    np.testing.assert_array_equal(read["values"][:, 1], results["car.yaw"])
    np.testing.assert_array_equal(read["time"], TIME)


def test_mdf(results: Results, tmp_path: Path) -> None:
    mdf = pytest.importorskip("asammdf")
    with mdf.MDF(convert(results, tmp_path / "r.mf4", every=0.5)) as measured:
        signal = measured.get("car.yaw")
        assert signal.unit == "rad"
        np.testing.assert_allclose(signal.timestamps, [0.0, 0.5, 1.0])
        np.testing.assert_array_equal(signal.samples, results["car.yaw"][[0, 5, 10]])


def test_rows() -> None:
    assert rows(TIME, 0.25).tolist() == [0, 3, 5, 8, 10]
    assert rows(TIME, 0.2).tolist() == [0, 2, 4, 6, 8, 10]
    assert rows(TIME[:4], 0.2).tolist() == [0, 2, 3], "the last row is always there"


def test_texts_are_equal_or_not(tmp_path: Path) -> None:
    one = load_results(folder_of(tmp_path / "one", said=np.array(["a"] * 11, object)))
    other = load_results(folder_of(tmp_path / "two", said=np.array(["a"] * 6 + ["b"] * 5, object)))
    (only,) = compare(one, other).beyond(1e9)
    assert (only.signal, only.at) == ("said", pytest.approx(0.6))
    assert not compare(one, one).beyond(0.0)


def test_mistakes(results: Results, tmp_path: Path) -> None:
    for patterns, sentence in (
        (["car.z"], r"unknown signal 'car\.z'.*car\.x"),
        (["bus.*"], "no signal fits the pattern"),
    ):
        with pytest.raises(CosimError, match=sentence):
            signals(results, patterns)
    with pytest.raises(CosimError, match=r"none of the suffixes \.csv, \.mat, \.mf4"):
        convert(results, tmp_path / "r.xlsx")
    for every in (math.nan, math.inf, -1.0):
        with pytest.raises(CosimError, match="must be finite and not negative"):
            rows(TIME, every)
    assert len(rows(TIME, 1e-12)) == len(TIME)
    with pytest.raises(CosimError, match="cannot be written: No such file"):
        convert(results, tmp_path / "none" / "r.csv")


def test_equal_runs_are_equal(results: Results, tmp_path: Path) -> None:
    found = compare(results, load_results(folder_of(tmp_path / "other")))
    assert not found.beyond(0.0) and len(found.differences) == 3


def test_differences(results: Results, tmp_path: Path) -> None:
    """x is shifted by 0.5 m of a range of 10 m; NaN is like no number."""
    hole = np.where(TIME > 0.55, math.nan, TIME)
    other = load_results(folder_of(tmp_path / "other", shift=0.5, new=hole))
    found = compare(results, other)
    (only,) = found.beyond(0.0)
    assert (only.signal, only.unit) == ("car.x", "m")
    assert only.largest == pytest.approx(0.5) and only.relative == pytest.approx(0.05)
    assert found.only_second == ["new"] and found.beyond(0.06) == []
    once_more = load_results(folder_of(tmp_path / "third", new=TIME))
    assert compare(other, once_more).beyond(0.0)[0].largest == math.inf


def test_other_rows_are_met_on_straight_lines(results: Results, tmp_path: Path) -> None:
    fine = load_results(folder_of(tmp_path / "fine", time=np.arange(0, 0.5001, 0.05)))
    found = {each.signal: each.largest for each in compare(results, fine).differences}
    assert found["car.x"] == pytest.approx(0.0, abs=1e-12)
    assert found["car.yaw"] == 0.0, "the same rows every 0.1 s"
    coarse = {each.signal: each.largest for each in compare(fine, results).differences}
    assert coarse["car.yaw"] == pytest.approx(0.05**2 / 2 * math.sin(0.45), rel=0.1)


def called(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr(sys, "argv", ["cosim", *map(str, words)])
    with pytest.raises(SystemExit) as left:
        main()
    return int(left.value.code or 0)


def test_the_commands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    one, other = folder_of(tmp_path / "one"), folder_of(tmp_path / "other", shift=0.5)
    assert called(monkeypatch, "convert", one, "-o", tmp_path / "r.csv", "--signal", "car.*") == 0
    assert (tmp_path / "r.csv").read_text().startswith('"time","car.x","car.yaw"\n')
    capsys.readouterr()
    assert called(monkeypatch, "compare", one, other, "--plot", tmp_path / "c.png") == 0
    assert "2 of 3 signals are equal to the bit" in capsys.readouterr().out
    assert (tmp_path / "c.png").stat().st_size > 5000
    assert called(monkeypatch, "compare", one, other, "--tolerance", "0.04") == 1
    assert "a signal differs by more than 0.04" in capsys.readouterr().err
    assert called(monkeypatch, "compare", one, other, "--tolerance", "0.06") == 0
    strange = folder_of(tmp_path / "strange", extra=TIME)
    assert called(monkeypatch, "compare", one, strange, "--tolerance", "1") == 1
    assert called(monkeypatch, "compare", one, strange, "--tolerance", "1", "--signal", "car.x") == 0
    assert called(monkeypatch, "show", one, "car.*", "-o", tmp_path / "s.svg") == 0
    assert "<svg" in (tmp_path / "s.svg").read_text()
    for variable in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(variable, raising=False)
    capsys.readouterr()
    for words, sentence in (
        (["show", one, "car.z"], "unknown signal"),
        (["show", one, "car.x", "-o", tmp_path / "s.xyz"], "no suffix of a picture"),
        (["show", tmp_path, "car.x"], "holds no results"),
        (["convert", one, "-o", "r.xyz"], "none of the suffixes"),
    ):
        assert called(monkeypatch, *words) == 2
        assert sentence in capsys.readouterr().err
    if sys.platform.startswith("linux"):
        assert called(monkeypatch, "show", one, "car.x") == 2
        assert "there is no screen" in capsys.readouterr().err
