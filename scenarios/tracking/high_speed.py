"""Accelerating, weaving and braking at once between 25 and 33 m/s."""

from scenarios.tracking.loop import tracking

WORK = tracking({"amplitude": 4.0, "initial_speed": 25.0, "acceleration": 2.0, "deceleration": 3.0})
