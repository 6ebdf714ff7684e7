"""Accelerating, weaving and braking at once between 25 and 33 m/s."""

from scenarios.tracking.loop import tracking

SCENARIO = tracking(
    "high-speed-tracking",
    "Overlapping acceleration, evasive weave and braking, 25 to 33 m/s, whole control system in the loop",
    "Fig. 4.10 (architecture of Fig. 4.9)",
    stop_time=16.0,
    reference={"amplitude": 4.0, "initial_speed": 25.0, "acceleration": 2.0, "deceleration": 3.0},
)
