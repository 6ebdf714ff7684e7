"""Weaving at a constant 30 m/s."""

from scenarios.tracking.loop import tracking

WORK = tracking({"amplitude": 4.0, "initial_speed": 30.0, "acceleration": 0.0, "deceleration": 0.0})
