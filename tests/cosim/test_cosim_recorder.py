import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pyarrow import parquet

from cosim.errors import CosimError
from cosim.model.signals import Signal
from cosim.results.reading import Facts, load_results
from cosim.results.recorder import Recorder, recorded
from cosim.results.storage import PARQUET, STREAM, group_rows

SIGNALS = [Signal("plant", "y", "m"), Signal("reference", "preview[3].speed", "m/s"), Signal("llc", "u", None)]


def test_array_signals_are_left_out():
    assert recorded(SIGNALS) == [0, 2]


def test_rows_units_and_order_survive(tmp_path):
    vector = np.zeros(4)
    recorder = Recorder(tmp_path, vector, SIGNALS, recorded(SIGNALS))
    for k in range(2500):
        vector[:] = k / 1000, k, -1.0, 2.0 * k
        recorder()
    recorder.close()
    results = load_results(tmp_path, Facts({"llc": 0.5, "plant": 0.001}))
    assert results.names == ["plant.y", "llc.u"]
    assert results.time.tolist() == [k / 1000 for k in range(2500)]
    assert results["llc.u"].tolist() == [2.0 * k for k in range(2500)]
    assert (results.unit("plant.y"), results.unit("llc.u"), results.unit("time")) == ("m", "", "s")
    assert results.instants("llc").tolist() == [0, 500, 1000, 1500, 2000]
    assert not (tmp_path / STREAM).exists()


def recorded_times(folder, every, stop, times):
    """Seconds, all given in ms."""
    vector = np.zeros(4)
    recorder = Recorder(folder, vector, SIGNALS, [0], every * 10**6, stop * 10**6)
    for k in times:
        vector[0] = k / 1000
        recorder()
    recorder.close()
    return load_results(folder, Facts({"llc": 0.02, "radio": 0.015})).time * 1000


def test_rows_every_so_often_and_at_the_end(tmp_path):
    times = recorded_times(tmp_path, 20, 70, [*range(70), 70])
    assert times.tolist() == [0.0, 20.0, 40.0, 60.0, 70.0]
    results = load_results(tmp_path, Facts({"llc": 0.02, "radio": 0.015}))
    assert results.instants("llc").tolist() == [0, 1, 2, 3]
    assert results.instants("radio").tolist() == [0, 3], "of its instants at 0, 15, 30, 45 and 60 ms two were recorded"


def test_a_row_that_no_tick_meets_is_taken_at_the_next(tmp_path):
    times = recorded_times(tmp_path, 20, 200, [0, 7, 30, 39, 40, 75, 100, 119, 200])
    assert times.tolist() == [0.0, 30.0, 40.0, 75.0, 100.0, 200.0]


def test_more_often_than_there_are_ticks_is_every_tick(tmp_path):
    assert recorded_times(tmp_path, 1, 9, range(0, 10, 3)).tolist() == [0.0, 3.0, 6.0, 9.0]


def test_wide_rows_and_many_row_groups(tmp_path, monkeypatch):
    """Chunks get shorter as rows get wider; row groups have equally many rows whatever the chunks were."""
    monkeypatch.setattr("cosim.results.recorder.CHUNK_VALUES", 4000)
    monkeypatch.setattr("cosim.results.storage.GROUP_VALUES", 50_000)
    monkeypatch.setattr("cosim.results.storage.COLUMN_OVERHEAD", 0)
    signals = [Signal(f"car{k}", "x", "m") for k in range(999)]
    vector = np.zeros(1000)
    recorder = Recorder(tmp_path, vector, signals, recorded(signals))
    for k in range(123):
        vector[:] = k + np.arange(1000.0) / 1000.0
        recorder()
        if k in (3, 77):
            recorder.flush()
    recorder.close()
    file = parquet.ParquetFile(tmp_path / PARQUET)
    assert [file.metadata.row_group(i).num_rows for i in range(file.num_row_groups)] == [51, 51, 21]
    results = load_results(tmp_path, Facts({}))
    assert results["car998.x"] == pytest.approx(np.arange(123.0) + 0.999, rel=1e-15)
    assert results.names == [signal.name for signal in signals]


@pytest.mark.parametrize(("rows", "columns"), [(1500, 5000), (60_000, 10_000), (60_000, 5000)])
def test_row_groups_of_many_columns_take_little_memory(rows, columns):
    """Values in a group and what is kept of all groups, against the best of all lengths of a group."""

    def held(length):
        return columns * (length + 256 * -(-rows // length))

    assert held(group_rows(rows, columns)) <= 1.1 * min(map(held, range(1, rows + 1)))


def test_the_last_row_is_no_sampling_instant(tmp_path):
    vector = np.zeros(4)
    recorder = Recorder(tmp_path, vector, SIGNALS, [0])
    for k in range(11):
        vector[:2] = k / 10, -k
        recorder()
    recorder.close()
    results = load_results(tmp_path, Facts({"llc": 0.5, "plant": 0.5}))
    assert results.instants("llc").tolist() == [0, 5]
    assert results.samples("plant", "y").tolist() == [0.0, -5.0]
    assert load_results(tmp_path, Facts({"llc": 0.5}, stop=1.0)).instants("llc").tolist() == [0, 5]
    assert load_results(tmp_path, Facts({"llc": 0.5}, stop=1.5)).instants("llc").tolist() == [0, 5, 10], (
        "it ended early"
    )


def test_unknown_signals_and_missing_results(tmp_path):
    with pytest.raises(CosimError, match="holds no results"):
        load_results(tmp_path, Facts({}))
    Recorder(tmp_path, np.zeros(4), SIGNALS, [0]).close()
    with pytest.raises(CosimError, match=r"unknown signal 'plant\.x'; did you mean plant\.y"):
        load_results(tmp_path, Facts({}))["plant.x"]


_ENDLESS = """
import sys, time
from pathlib import Path
import numpy as np
from cosim.model.signals import Signal
from cosim.results.recorder import Recorder
vector = np.zeros(2)
recorder = Recorder(Path(sys.argv[1]), vector, [Signal("plant", "y", "m")], [0])
for k in range(10**9):
    vector[:] = k / 1000, k
    recorder()
    if k == 5000:
        print("written", flush=True)
        time.sleep(60)
"""


def test_a_killed_run_keeps_what_it_had(tmp_path):
    process = subprocess.Popen(
        [sys.executable, "-c", _ENDLESS, str(tmp_path)], stdout=subprocess.PIPE, cwd=Path(__file__).parents[2]
    )
    assert process.stdout is not None
    process.stdout.readline()
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    process.stdout.close()
    results = load_results(tmp_path, Facts({}))
    assert len(results.time) == 4608
    assert results["plant.y"].tolist() == list(range(4608))
    with (tmp_path / STREAM).open("r+b") as stream:  # killed in the middle of writing a chunk
        stream.truncate((tmp_path / STREAM).stat().st_size - 1000)
    results = load_results(tmp_path, Facts({"plant": 0.001}))
    assert results["plant.y"].tolist() == list(range(4096))
    assert results.instants("plant").tolist() == list(range(4096)), "the last row is no stop time"
    Recorder(tmp_path, np.zeros(4), SIGNALS, [0]).close()
    assert (tmp_path / PARQUET).exists()


def test_a_slow_run_is_flushed_by_the_clock(tmp_path, monkeypatch):
    now = [0.0]
    monkeypatch.setattr("cosim.results.recorder.monotonic", lambda: now[0])
    recorder = Recorder(tmp_path, np.zeros(4), SIGNALS, [0])
    recorder()
    recorder.keep()
    assert len(load_results(tmp_path, Facts({})).time) == 0
    now[0] = 10.0
    recorder.keep()
    assert len(load_results(tmp_path, Facts({})).time) == 1
    recorder.close()
