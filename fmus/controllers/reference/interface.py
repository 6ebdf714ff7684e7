"""What ReferenceTrajectory shows."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import CsvTable, load_parameters, output, sampled
from fmus.controllers.bus import SAMPLE, trajectory_bus

ROWS = 4000
COLUMNS = ("time", *SAMPLE)

INTERFACE = sampled(
    "ReferenceTrajectory",
    "Plays a built-in high-speed manoeuvre, or the trajectory of a CSV file, with a preview of 3 s",
    step=0.020,
    variables=[*load_parameters(Path(__file__).with_name("parameters.toml")), *trajectory_bus(output)],
    table=CsvTable("trajectory_file", COLUMNS, ROWS),
)
