"""What a replay may change: durations that an FMU measures while its parameter `solver.timed` is true, nothing else."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from dataclasses import replace

from raw_fmi import Variable

from fmukit.runtime.state import Snapshot

SWITCH, ENDING = "solver.timed", ".time"


def replayable(image: Snapshot, variables: Sequence[Variable]) -> Snapshot:
    """The image with zeros for the outputs that are measured durations, and for their values wherever they are kept.

    The image itself while nothing is measured.
    """
    slots, buffer = {v.name: v.vr for v in variables}, array("d", image.buffer)
    if SWITCH not in slots or not buffer[slots[SWITCH]]:
        return image
    measured = {buffer[v.vr] for v in variables if v.causality == "output" and v.name.endswith(ENDING)}
    return replace(image, buffer=array("d", (0.0 if value in measured else value for value in buffer)).tobytes())
