"""Sequences of FMI calls, legal or not, over every FMU: nothing crashes, nothing lies, what is refused leaves no trace.

The rules are in `fuzz_machine`, what must hold in `fuzz_life`. Each FMU is fuzzed in a process of its own.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from broken_copy import copy_with
from raw_fmi import Fmu

from fmus import CATALOGUE

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the fuzzer calls the Linux binaries")
NAMES = [component.interface.name for component in CATALOGUE]
SLOW = {"ReferenceTrajectory": 0.12}  # its state holds the whole trajectory: 0.4 MB to compare after every call
ROOT = Path(__file__).parents[2]


def share(name: str, total: int) -> int:
    """How many of `total` sequences over the catalogue fall to this FMU."""
    weights = {each: SLOW.get(each, 1.0) for each in NAMES}
    return 1 + int(total * weights[name] / sum(weights.values()))


def fuzz(folder: Path, sequences: int, seed: int) -> Counter[str]:
    """What was done; fails with the shortest sequence found, or with the last calls of a process that died."""
    journal = folder.with_suffix(f".{seed}.journal")
    done = subprocess.run(
        [sys.executable, "fuzz_worker.py", str(folder), str(sequences), str(seed), str(journal)],
        cwd=Path(__file__).parent,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
        timeout=60 + sequences,
    )
    if done.returncode < 0:
        calls = "\n".join(journal.read_text(errors="replace").splitlines()[-40:])
        pytest.fail(f"{folder.name}: the process died of signal {-done.returncode} in\n{calls}\n{done.stderr[-2000:]}")
    assert done.returncode == 0, done.stderr[-4000:]
    return Counter(json.loads(done.stdout.splitlines()[-1]))


def check(done: Counter[str], sequences: int) -> None:
    """The sequences were run, and reached what they are meant to reach."""
    assert done["sequences"] >= sequences
    assert done["calls"] > 10 * sequences
    assert done["steps"] > sequences / 10  # forty sequences hold between 15 and 500: the draws change with the sources
    assert done["refused"] > sequences


@pytest.mark.parametrize("name", NAMES)
def test_five_hundred_sequences_over_the_catalogue(unzipped: dict[str, Path], name: str) -> None:
    sequences = share(name, 500)
    check(fuzz(unzipped[name], sequences, 1), sequences)


@pytest.mark.nightly
@pytest.mark.parametrize("name", NAMES)
def test_twenty_thousand_sequences_over_the_catalogue(unzipped: dict[str, Path], name: str) -> None:
    sequences = share(name, 20_000)
    done = fuzz(unzipped[name], sequences, 2)
    check(done, sequences)
    assert min(done["texts"], done["bytes"]) >= 1


def test_a_crash_is_reported_with_its_calls(tmp_path: Path, unzipped: dict[str, Path]) -> None:
    """The fuzzer itself: an FMU whose step kills the process is found out, with the call that did it."""
    folder = tmp_path / "Imu"
    step = "        try:\n            if life.mode != STEPPING"
    copy_with(folder, unzipped["Imu"], "steps.py", step, "        __import__('os').abort()")
    with pytest.raises(pytest.fail.Exception, match=r"died of signal 6 in\n(.*\n)*.*doStep"):
        fuzz(folder, 50, 1)


def test_a_refused_call_with_an_effect_is_found(tmp_path: Path, unzipped: dict[str, Path]) -> None:
    """The fuzzer itself: a slave that stores a value before it checks it is found out."""
    folder = tmp_path / "Imu"
    early = "        for slot, value in zip(access.slots, values): self._buffer[slot] = value"
    copy_with(folder, unzipped["Imu"], "values.py", "        misfit = access", early)
    with pytest.raises(AssertionError, match="set_anything"):
        fuzz(folder, 50, 1)


def test_a_replay_that_goes_elsewhere_is_found(tmp_path: Path, unzipped: dict[str, Path]) -> None:
    """The fuzzer itself: an FMU is found out whose outputs depend on what its states do not hold."""
    folder = tmp_path / "Imu"
    slot = next(v.vr for v in Fmu(unzipped["Imu"]).variables if v.name == "accelerometer.x")
    clock = f"            core.buffer[{slot}] += __import__('time').perf_counter()"
    copy_with(folder, unzipped["Imu"], "steps.py", "            life.time = time + size", clock)
    with pytest.raises(AssertionError, match="a replay went elsewhere"):
        fuzz(folder, 50, 1)
