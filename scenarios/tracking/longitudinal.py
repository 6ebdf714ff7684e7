"""Straight ahead: 15 -> 30 -> 15 m/s at 3 m/s2."""

from scenarios.tracking.loop import tracking

# A phase from start to end with rise r changes the speed by height * (end - start - r): 3 * (5.5 - 0.5) = 15 m/s.
SCENARIO = tracking(
    "longitudinal-tracking",
    "Accelerating and braking on a straight line, 15 to 30 m/s and back at 3 m/s2",
    "Figs. 4.5, 4.6 and 4.8, left",
    stop_time=17.0,
    reference={
        "amplitude": 0.0,
        "initial_speed": 15.0,
        "acceleration": 3.0,
        "acceleration.start": 1.5,
        "acceleration.end": 7.0,
        "deceleration": 3.0,
        "deceleration.start": 9.5,
        "deceleration.end": 15.0,
    },
)
