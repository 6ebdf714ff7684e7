"""What the fuzzer lets a replay change: durations that the FMU measures because it was told to, and nothing else."""

from __future__ import annotations

import os
import sys
from array import array
from dataclasses import replace
from pathlib import Path

import pytest
from fuzz_durations import SWITCH, replayable
from fuzz_life import Life, Subject
from raw_fmi import Fmu, Variable

from fmukit.runtime.state import Snapshot

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the fuzzer calls the Linux binaries")
every_timed = pytest.mark.parametrize(("name", "size"), {"MpcAllocator": 0.02, "RecedingHorizonPlanner": 1.6}.items())
"""The FMUs that can measure, and a step [s] within which they solve something."""


def _replays(folder: Path, size: float, *, timed: bool) -> tuple[list[Variable], list[Snapshot]]:
    """The variables, and the images after one step from one state: of an instance, of it again, and of another."""
    subject = Subject(Fmu(folder), os.open(os.devnull, os.O_WRONLY))
    life, other = Life(subject, "life"), Life(subject, "other")
    life.set("Boolean", [v.vr for v in subject.fmu.variables if v.name == SWITCH], [timed])
    life.setup()
    life.enter()
    life.exit()
    state, twin, image = life.save(), life.twin, life.image
    images = []
    for player in (life, life, other):
        player.restore(state, twin, image)
        player.step(0.0, size)
        images.append(player.image)
    life.free()
    other.free()
    os.close(subject.journal)
    return subject.fmu.variables, images


def _durations(variables: list[Variable]) -> list[int]:
    return [v.vr for v in variables if v.causality == "output" and v.name.endswith(".time")]


def _changed(image: Snapshot, slot: int) -> Snapshot:
    buffer = array("d", image.buffer)
    buffer[slot] += 1.0 + abs(buffer[slot])
    return replace(image, buffer=buffer.tobytes())


@every_timed
def test_measured_durations_may_change(unzipped: dict[str, Path], name: str, size: float) -> None:
    variables, images = _replays(unzipped[name], size, timed=True)
    assert all(array("d", image.buffer)[vr] > 0.0 for image in images for vr in _durations(variables))
    assert images[0] != images[1]
    first, *again = (replayable(image, variables) for image in images)
    assert again == [first, first]


@every_timed
def test_no_other_number_may_change_while_they_are_measured(unzipped: dict[str, Path], name: str, size: float) -> None:
    """Two durations that MpcAllocator shows; one that RecedingHorizonPlanner shows, and keeps beside its plan."""
    variables, (image, *_) = _replays(unzipped[name], size, timed=True)
    whole, kept = array("d", image.buffer), array("d", replayable(image, variables).buffer)
    left_out = [slot for slot, value in enumerate(whole) if kept[slot] != value]
    assert len(left_out) == 2
    assert {whole[slot] for slot in left_out} == {whole[vr] for vr in _durations(variables)}
    assert replayable(_changed(image, len(whole) - 1), variables) != replayable(image, variables)


@every_timed
def test_nothing_may_change_while_nothing_is_measured(unzipped: dict[str, Path], name: str, size: float) -> None:
    variables, images = _replays(unzipped[name], size, timed=False)
    assert images[0] == images[1] == images[2] == replayable(images[0], variables)
    for slot in _durations(variables):
        assert replayable(_changed(images[0], slot), variables) != images[0]
