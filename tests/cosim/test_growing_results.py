"""Long runs: the results go into the Parquet file while they last, and a killed run keeps all but the latest rows."""

import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from cosim_mocks import Mock, face, plan_of
from pyarrow import parquet

from cosim.model.signals import Signal
from cosim.model.system import System
from cosim.results import growing, recorder
from cosim.results.columns import Texts
from cosim.results.growing import FOOTER, PARTIAL
from cosim.results.reading import load_results
from cosim.results.recorder import Recorder
from cosim.results.storage import PARQUET, STREAM
from cosim.run.running import execute
from cosim.run.volume import expected_rows, remarks

SIGNALS = [Signal("plant", "y", "m"), Signal("plant", "n", None, "Integer")]


@pytest.fixture(params=["plain", "mixed"])
def kinds(request, monkeypatch) -> list[Signal]:
    """Doubles only or several types, in groups of 200 or 150 rows, three of which make a span."""
    monkeypatch.setattr("cosim.results.storage.GROUP_VALUES", 598)
    monkeypatch.setattr("cosim.results.storage.COLUMN_OVERHEAD", 0)
    monkeypatch.setattr(recorder, "SPAN_VALUES", 1800)
    return SIGNALS if request.param == "mixed" else [SIGNALS[0], Signal("plant", "n", None)]


def group(signals: list[Signal]) -> int:
    """Rows in a group of three columns, or of four."""
    return 150 if signals is SIGNALS else 200


def rows(folder: Path, signals: list[Signal], count: int, every: int = 10**9, expected: int = 5000) -> Iterator[int]:
    """Records `count` rows, flushing every so many; yields after each row, and once when the file is closed."""
    vector = np.zeros(3)
    words: list[str] = [""]
    texts = Texts([Signal("plant", "word", None, "String")], words) if signals is SIGNALS else None
    made = Recorder(folder, vector, signals, [0, 1], about={b"cosim": b"{}"}, texts=texts, rows=expected)
    for k in range(count):
        vector[:] = k / 1000, k, -k
        words[0] = f"word {k}"
        made()
        if k % every == 0:
            made.flush()
        yield k
    made.close()
    yield count


def check(folder: Path, count: int) -> None:
    results = load_results(folder)
    assert results.time.tolist() == [k / 1000 for k in range(count)]
    assert results["plant.n"].tolist() == [-k for k in range(count)]
    assert results.unit("plant.y") == "m"
    if "plant.word" in results:
        assert results["plant.word"].tolist() == [f"word {k}" for k in range(count)]


@pytest.mark.parametrize("count", [0, 1, 449, 450, 451, 599, 600, 601, 1800, 4321])
def test_the_file_is_whole_in_the_end(tmp_path, kinds, count):
    size = group(kinds)
    for _ in rows(tmp_path, kinds, count):
        pass
    check(tmp_path, count)
    assert [path.name for path in tmp_path.iterdir()] == [PARQUET]
    file = parquet.ParquetFile(tmp_path / PARQUET)
    groups = [file.metadata.row_group(i).num_rows for i in range(file.num_row_groups)]
    assert groups == [size] * (count // size) + [count % size] * bool(count % size)
    assert file.schema_arrow.metadata[b"cosim"] == b"{}"


def test_neither_file_grows_with_the_run_but_the_one_that_stays(tmp_path, kinds):
    largest = 0
    for k in rows(tmp_path, kinds, 4900, every=50):
        if (tmp_path / STREAM).is_file() and k % 50 == 0:
            largest = max(largest, (tmp_path / STREAM).stat().st_size)
    assert largest < 600 * 3 * 8 * 3, "the stream holds one span, with what Arrow puts around its chunks"


def test_the_bytes_do_not_depend_on_when_it_was_flushed(tmp_path, kinds):
    for every in (7, 1000):
        (tmp_path / str(every)).mkdir()
        for _ in rows(tmp_path / str(every), kinds, 3210, every):
            pass
    assert (tmp_path / "7" / PARQUET).read_bytes() == (tmp_path / "1000" / PARQUET).read_bytes()


def test_a_run_killed_at_any_row_keeps_what_was_flushed(tmp_path, kinds):
    folder = tmp_path / "run"
    folder.mkdir()
    for k in rows(folder, kinds, 1900, every=100):
        if k % 100 == 0 and k < 1900:
            shutil.copytree(folder, tmp_path / "killed")
            check(tmp_path / "killed", k + 1)
            shutil.rmtree(tmp_path / "killed")


def test_a_run_killed_between_two_files_has_every_row_once(tmp_path, kinds, monkeypatch):
    """After the groups got their footer, while the old stream is still there, and when there is no new one yet."""
    begun = []

    def killed(*_args):
        if begun:
            raise KeyboardInterrupt
        begun.append(True)
        return sink(*_args)

    sink = recorder.sink
    monkeypatch.setattr(recorder, "sink", killed)
    with pytest.raises(KeyboardInterrupt):
        for _ in rows(tmp_path, kinds, 4000):
            pass
    assert {path.name for path in tmp_path.iterdir()} == {STREAM, PARTIAL, FOOTER}
    check(tmp_path, 3 * group(kinds))
    (tmp_path / STREAM).write_bytes(b"")
    check(tmp_path, 3 * group(kinds))
    (tmp_path / STREAM).unlink()
    check(tmp_path, 3 * group(kinds))


def test_groups_without_a_footer_count_only_once_they_have_one(tmp_path, kinds, monkeypatch):
    written = []

    def killed(*args):
        if len(written) == 2:
            raise KeyboardInterrupt
        written.append(True)
        return write(*args)

    write = growing.files.write
    monkeypatch.setattr(growing.files, "write", killed)
    with pytest.raises(KeyboardInterrupt):
        for _ in rows(tmp_path, kinds, 4000):
            pass
    check(tmp_path, 9 * group(kinds))


def test_a_disk_that_fills_up_keeps_every_row(tmp_path, kinds, monkeypatch):
    written = []

    def full(*args):
        if len(written) == 2:
            raise OSError(28, "No space left on device")
        written.append(True)
        return write(*args)

    write = growing.files.write
    monkeypatch.setattr(growing.files, "write", full)
    with pytest.raises(OSError, match="No space"):
        for _ in rows(tmp_path, kinds, 4000):
            pass
    check(tmp_path, 9 * group(kinds))


_ENDLESS = """
import sys
sys.path[:0] = [{tests!r}, {root!r}]
from pathlib import Path
from cosim.results import recorder
from test_growing_results import SIGNALS, rows
recorder.SPAN_VALUES = 1800
for k in rows(Path(sys.argv[1]), SIGNALS, 10**9, expected=2000):
    if k == 600_000:
        print("there", flush=True)
"""


def test_a_run_killed_by_the_system(tmp_path):
    program = _ENDLESS.format(tests=str(Path(__file__).parent), root=str(Path(__file__).parents[2]))
    with subprocess.Popen([sys.executable, "-c", program, str(tmp_path)], stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        process.stdout.readline()
        process.send_signal(signal.SIGKILL)
    results = load_results(tmp_path)
    assert len(results.time) > 600_000 - 512, "at most one chunk is lost"
    check(tmp_path, len(results.time))


def test_how_many_rows_there_will_be(tmp_path):
    system = System()
    system.add("plant", "Mock")
    mock = Mock(face({}, {"y": "m"}, step=0.001), lambda t, h, u: {"y": t})
    plan = plan_of(system, {"plant": mock}, tmp_path, stop=1.0)
    expected = expected_rows(plan.request, plan.schedule, plan.nodes)
    execute(plan, lambda: {"plant": mock})
    assert len(load_results(tmp_path).time) == 1001 <= expected <= 1002


def test_large_results_are_told_before(tmp_path, monkeypatch):
    assert not list(remarks(10_000, 100, tmp_path))
    (told,) = remarks(1_800_001, 153, tmp_path)
    assert told.startswith("the results will take about 1.1 GB (1800001 rows of 153 values)")
    monkeypatch.setattr(shutil, "disk_usage", lambda _folder: shutil._ntuple_diskusage(10**9, 9 * 10**8, 10**8))
    (told,) = remarks(1_800_001, 153, tmp_path)
    assert told.endswith(f", but {tmp_path} has 0.1 GB free; --record-every S records fewer rows")
