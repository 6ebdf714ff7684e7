"""Where an instance stands in its life: the one record of it, which an FMU state holds a copy of."""

from __future__ import annotations

from dataclasses import dataclass

INSTANTIATED, INITIALISING, STEPPING, TERMINATED = range(4)
MODES = ("instantiated", "initialisation", "stepping", "terminated")


@dataclass(slots=True)
class Life:
    """Everything an instance remembers beside its buffer and its texts.

    mode      one of INSTANTIATED, INITIALISING, STEPPING, TERMINATED
    dirty     parameters or inputs have changed since derived values, states and outputs were computed from them
    pending   a call was refused, so the next step will be discarded
    broken    there is no valid state, so every step is discarded until a reset
    anchored  the first step was done, so `origin` and `time` count
    samples   how many instants of the sampling grid have passed; 0 for a continuous component
    origin    when the first step began [s], which is where the sampling grid starts
    time      when the last step ended [s]
    """

    mode: int = INSTANTIATED
    dirty: bool = True
    pending: bool = False
    broken: bool = False
    anchored: bool = False
    samples: int = 0
    origin: float = 0.0
    time: float = 0.0
