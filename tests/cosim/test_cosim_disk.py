"""A disk that is full or cannot be written: one sentence, no traceback, and never a mixture of two runs in a folder."""

import errno
import json
import os
import resource
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from cosim_mocks import Mock, face, plan_of, scenario_of

from cosim.command import main as cli
from cosim.engine.models import find
from cosim.errors import CosimError, unknown
from cosim.model.system import System
from cosim.results import recorder, storage
from cosim.results.reading import Facts, load_results
from cosim.results.summary import Summary
from cosim.run.claim import LOCK
from cosim.run.request import Request
from cosim.run.running import execute, run
from fmukit.errors import because
from fmukit.unpacking import ArchiveError, unpack

FULL = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
ROOT = Path(__file__).parents[2]


def fail(*_args, **_options):
    raise FULL


def mocked(folder, step=lambda t, h, u: {"y": t}):
    """`execute` on one mocked plant of 1 ms, for 2 s."""
    system = System()
    system.add("plant", "Mock")
    mock = Mock(face({}, {"y": "m"}, step=0.001), step)
    return execute(plan_of(system, {"plant": mock}, folder, stop=2.0), lambda: {"plant": mock})


def tanks(tank, folder, *assignments):
    def build(_settings, _prepared):
        system = System()
        system.add("tank", "Tank", period=0.01)
        return system

    return Request(scenario_of("tanks", build), folder, assignments, find=lambda model: tank)


_LIMITED = """
import resource, sys
sys.path[:0] = [{tests!r}, {root!r}]
from pathlib import Path
from test_cosim_disk import mocked
resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, resource.RLIM_INFINITY))
print(mocked(Path(sys.argv[1])))
"""


def test_a_disk_that_fills_up_ends_the_run_and_keeps_whole_chunks(tmp_path):
    """A real limit of the system on the size of files, in a process of its own."""
    program = _LIMITED.format(tests=str(Path(__file__).parent), root=str(ROOT))
    done = subprocess.run([sys.executable, "-c", program, str(tmp_path)], capture_output=True, text=True, check=False)
    assert "status='failed', reason='the results cannot be written at" in done.stdout, done.stderr
    assert "File too large" in done.stdout
    assert load_results(tmp_path, Facts({}))["plant.y"].tolist() == [k / 1000 for k in range(1024)]


def test_parquet_that_cannot_be_written_leaves_the_stream(tmp_path, monkeypatch):
    monkeypatch.setattr("pyarrow.parquet.ParquetWriter.write_table", fail)
    outcome = mocked(tmp_path)
    assert (outcome.status, outcome.reason) == ("failed", "the results cannot be written: No space left on device")
    assert [path.name for path in tmp_path.iterdir()] == [storage.STREAM]
    assert len(load_results(tmp_path, Facts({})).time) == 2001


def test_the_slave_that_failed_is_named_even_if_the_disk_is_full_too(tmp_path, monkeypatch):
    monkeypatch.setattr("pyarrow.parquet.ParquetWriter.write_table", fail)
    assert mocked(tmp_path, lambda t, h, u: 3).reason.startswith("plant failed at 0 s")


def test_a_failed_recording_still_gets_its_summary(tank, tmp_path, monkeypatch):
    monkeypatch.setattr(recorder.Recorder, "keep", fail)
    made = run(tanks(tank, tmp_path)).summary
    assert made.reason == "the results cannot be written at 0.63 s: No space left on device"
    assert json.loads((tmp_path / "summary.json").read_text()) == made.data()


def test_a_summary_that_cannot_be_written(tank, tmp_path, monkeypatch):
    monkeypatch.setattr(Summary, "json", fail)
    finished = run(tanks(tank, tmp_path))
    made, results = finished.summary, finished.results
    assert made.status == "failed"
    assert made.reason == f"{tmp_path / 'summary.json'} cannot be written: No space left on device"
    assert len(results.time) == 101
    assert {path.name for path in tmp_path.iterdir()} - {LOCK} == {storage.PARQUET}


@pytest.mark.parametrize("name", ["summary.json", "overview.png", "results.parquet"])
def test_what_is_in_the_way_is_named_before_the_run(tmp_path, name):
    (tmp_path / name).mkdir()
    with pytest.raises(CosimError, match=f"cannot write into .*{name}: Is a directory"):
        mocked(tmp_path)


def test_a_later_run_never_mixes_with_an_earlier_one(tank, tmp_path, monkeypatch):
    run(tanks(tank, tmp_path))
    (tmp_path / "overview.png").write_bytes(b"of the first run")
    with pytest.raises(CosimError, match="unknown instance"):
        run(tanks(tank, tmp_path, ("tonk.inflow", "1")))
    assert (tmp_path / "overview.png").exists(), "a run that never started leaves the folder alone"
    monkeypatch.setattr("cosim.run.running.Master.run", lambda *args: sys.exit(9))  # as if killed while running
    with pytest.raises(SystemExit):
        run(tanks(tank, tmp_path))
    assert {path.name for path in tmp_path.iterdir()} - {LOCK} == {storage.PARQUET}
    assert len(load_results(tmp_path, Facts({})).time) == 0


def test_the_command_says_when_the_picture_cannot_be_drawn(tank, tmp_path, capsys, monkeypatch, offer):
    offer(tanks(tank, tmp_path).scenario, {"Tank": tank})
    monkeypatch.setattr("cosim.run.running.Finished.draw", fail)
    monkeypatch.setattr(sys, "argv", ["cosim", "run", "tanks", "--quiet", "-o", str(tmp_path)])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert end.value.code == 1
    assert capsys.readouterr().err == (
        f"cosim: {tmp_path}/overview.png cannot be written: No space left on device; results and summary are complete\n"
    )


def test_the_last_resort_is_one_sentence(monkeypatch, capsys):
    monkeypatch.setattr("cosim.command.list.names", fail)
    monkeypatch.setattr(sys, "argv", ["cosim", "list"])
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert (end.value.code, capsys.readouterr().err) == (1, "cosim: No space left on device\n")


def test_an_unwritable_cache(monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc/nope")
    with pytest.raises(CosimError, match=r"cannot build Imu: the cache folder /proc/nope.*XDG_CACHE_HOME"):
        find("Imu")


def test_a_cache_that_fills_up(monkeypatch):
    monkeypatch.setattr("fmus.supply.cached", fail)
    with pytest.raises(CosimError, match=r"cannot keep the built Imu in .*: No space left on device; make room there"):
        find("Imu")


def test_unpacking_onto_a_full_disk_is_not_the_fault_of_the_archive(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("big", b"x" * 50_000)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, before[1]))
    try:
        with pytest.raises(ArchiveError, match=r"cannot unpack .*a\.zip into .*: File too large; make room .* TMPDIR"):
            unpack(tmp_path / "a.zip", tmp_path / "out")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_damaged_archive_is(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("big", bytes(range(256)) * 100)
    data = bytearray((tmp_path / "a.zip").read_bytes())
    data[60:70] = b"\xff" * 10
    (tmp_path / "a.zip").write_bytes(data)
    with pytest.raises(ArchiveError, match="not a readable zip archive"):
        unpack(tmp_path / "a.zip", tmp_path / "out")


def test_a_name_like_no_other_comes_with_where_to_look():
    names = [f"variable{k}" for k in range(20)]
    assert str(unknown("variable", "zzz", names, "look here")) == "unknown variable 'zzz'; look here"
    assert "variable1" in str(unknown("variable", "variabel1", names, "look here"))


def test_error_numbers_stay_out_of_sentences():
    assert because(OSError("Error writing bytes. Detail: [errno 27] File too large")) == "File too large"
    assert because(OSError(2, "No such file")) == "No such file"
