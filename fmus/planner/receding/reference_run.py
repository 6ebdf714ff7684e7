"""RecedingHorizonPlanner: the built-in road."""

from __future__ import annotations

from fmukit.reference_run import ReferenceRun

RUN = ReferenceRun(
    "The built-in road from 15 m/s: four curves, then braking to a stop beyond its end.",
    stop=36.0,
    step=0.2,
    plots={
        "Position now": ("reference.x", "reference.y"),
        "Speed now and 3 s ahead": ("reference.speed", "preview[60].speed"),
        "Acceleration": ("reference.acceleration",),
        "Curvature": ("reference.curvature",),
        "Planned up to": ("plan.end_time",),
        "Searches so far": ("problem.count",),
    },
)
