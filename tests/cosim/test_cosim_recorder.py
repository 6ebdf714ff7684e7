import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from cosim.errors import CosimError
from cosim.master import Signal
from cosim.recorder import PARQUET, STREAM, Recorder, recorded
from cosim.results import load_results

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
    results = load_results(tmp_path, {"llc": 0.5, "plant": 0.001})
    assert results.names == ["plant.y", "llc.u"]
    assert results.time.tolist() == [k / 1000 for k in range(2500)]
    assert results["llc.u"].tolist() == [2.0 * k for k in range(2500)]
    assert (results.unit("plant.y"), results.unit("llc.u"), results.unit("time")) == ("m", "", "s")
    assert results.instants("llc").tolist() == [0, 500, 1000, 1500, 2000]
    assert not (tmp_path / STREAM).exists()


def test_the_last_row_is_no_sampling_instant(tmp_path):
    vector = np.zeros(4)
    recorder = Recorder(tmp_path, vector, SIGNALS, [0])
    for k in range(11):
        vector[:2] = k / 10, -k
        recorder()
    recorder.close()
    results = load_results(tmp_path, {"llc": 0.5, "plant": 0.5})
    assert results.instants("llc").tolist() == [0, 5]
    assert results.samples("plant", "y").tolist() == [0.0, -5.0]


def test_unknown_signals_and_missing_results(tmp_path):
    with pytest.raises(CosimError, match="holds no results"):
        load_results(tmp_path, {})
    Recorder(tmp_path, np.zeros(4), SIGNALS, [0]).close()
    with pytest.raises(CosimError, match=r"unknown signal 'plant\.x'; did you mean plant\.y"):
        load_results(tmp_path, {})["plant.x"]


_ENDLESS = """
import sys, time
from pathlib import Path
import numpy as np
from cosim.master import Signal
from cosim.recorder import Recorder
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
    results = load_results(tmp_path, {})
    assert len(results.time) == 4608
    assert results["plant.y"].tolist() == list(range(4608))
    with (tmp_path / STREAM).open("r+b") as stream:  # killed in the middle of writing a chunk
        stream.truncate((tmp_path / STREAM).stat().st_size - 1000)
    assert load_results(tmp_path, {})["plant.y"].tolist() == list(range(4096))
    Recorder(tmp_path, np.zeros(4), SIGNALS, [0]).close()
    assert (tmp_path / PARQUET).exists()


def test_a_slow_run_is_flushed_by_the_clock(tmp_path, monkeypatch):
    now = [0.0]
    monkeypatch.setattr("cosim.recorder.monotonic", lambda: now[0])
    recorder = Recorder(tmp_path, np.zeros(4), SIGNALS, [0])
    recorder()
    recorder.keep()
    assert len(load_results(tmp_path, {}).time) == 0
    now[0] = 10.0
    recorder.keep()
    assert len(load_results(tmp_path, {}).time) == 1
    recorder.close()
