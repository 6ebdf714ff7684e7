"""How the head of a platoon drives, as a trajectory file."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np

from cosim.model.signals import Vector
from fmus.controllers.reference.interface import COLUMNS
from fmus.planner.files import write_table
from scenarios.platoon.events import END, Span
from scenarios.platoon.excitation import braking, multisine, straight
from scenarios.platoon.row import SPEED
from scenarios.shared.plans import kept

_SWEEP = 0.8
"""Root mean square of the head's acceleration in the sweep [m/s2]; the largest is 2 m/s2."""


def head_file(events: Mapping[str, Span]) -> Path:
    """The trajectory of the head, written if it is not there yet; raises CosimError when it cannot be kept."""
    t = np.linspace(0.0, END + 5.0, 3401)
    rows = straight(t, *head_motion(t, events))
    return kept("platoon", [rows.tobytes()], partial(write_table, COLUMNS, rows), "writing how the head drives in")


def head_motion(t: Vector, events: Mapping[str, Span]) -> tuple[Vector, Vector]:
    """Speed (n,) [m/s] of the head and its rate (n,) [m/s2] at the times t [s]."""
    speed, rate = np.full_like(t, SPEED), np.zeros_like(t)
    if "sweep" in events:
        more = multisine(t, _SWEEP)
    elif "braking" in events:
        more = braking(t - events["braking"].begin)
    else:
        return speed, rate
    return speed + more[0], rate + more[1]
