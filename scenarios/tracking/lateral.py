"""Weaving at a constant 30 m/s."""

from scenarios.tracking.loop import tracking

SCENARIO = tracking(
    "lateral-tracking",
    "Evasive weave at a constant 30 m/s",
    "Figs. 4.5, 4.6 and 4.8, right",
    stop_time=16.0,
    reference={"amplitude": 4.0, "initial_speed": 30.0, "acceleration": 0.0, "deceleration": 0.0},
)
