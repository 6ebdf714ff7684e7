"""Results made from arrays instead of a run."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa

from cosim.results.reading import Facts, Results
from fmukit.interface import load_parameters
from fmus.controllers.formation import bus

STEP = 0.02
STARTS = {v.name: v.start for v in load_parameters(Path(bus.__file__).with_name("parameters.toml"))}
"""Start values of the followers' parameters."""


def drive(
    poses: Mapping[int, np.ndarray],
    offsets: Mapping[int, tuple[float, float]],
    parameters: Mapping[str, float] | None = None,
    **columns: np.ndarray,
) -> Results:
    """Cars with poses x, y, yaw (n, 3) every 20 ms; `offsets` of the followers, constant unless `columns` say else.

    They were commanded from the beginning. `parameters` are those of all followers that are not at their start values.
    Columns have two underscores for a dot: `car2__follower__formation__x`.
    """
    n = len(next(iter(poses.values())))
    table = {"time": STEP * np.arange(n)}
    for car, pose in poses.items():
        names = ("position.x", "position.y", "yaw", "velocity.x", "angular_rate.z")
        values = np.column_stack((pose, np.zeros((n, 2))))
        table |= {f"car{car}.plant.{name}": values[:, i] for i, name in enumerate(names)}
    for car, offset in offsets.items():
        table |= {f"car{car}.follower.offset.{axis}": np.full(n, offset[i]) for i, axis in enumerate("xy")}
        table |= {f"car{car}.follower.command.acceleration": np.zeros(n)}
    table |= {name.replace("__", "."): column for name, column in columns.items()}
    told = {
        f"car{car}.follower": {"formation.x": offset[0], "formation.y": offset[1], **STARTS, **(parameters or {})}
        for car, offset in offsets.items()
    }
    return Results(pa.table(table), Facts(dict.fromkeys(told, STEP), values=told))
