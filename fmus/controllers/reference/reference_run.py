"""ReferenceTrajectory: the built-in manoeuvre."""

from __future__ import annotations

from fmukit.reference_run import ReferenceRun

RUN = ReferenceRun(
    "The built-in manoeuvre: speed up while weaving, then brake into a last turn.",
    stop=20.0,
    step=0.1,
    plots={
        "Position now": ("reference.x", "reference.y"),
        "Speed now and 3 s ahead": ("reference.speed", "preview[60].speed"),
        "Acceleration": ("reference.acceleration",),
        "Curvature": ("reference.curvature",),
    },
)
