"""Straight ahead: 15 -> 30 -> 15 m/s at 3 m/s2."""

from scenarios.tracking.loop import tracking

# A phase from start to end with rise r changes the speed by height * (end - start - r): 3 * (5.5 - 0.5) = 15 m/s.
WORK = tracking(
    {
        "amplitude": 0.0,
        "initial_speed": 15.0,
        "acceleration": 3.0,
        "acceleration.start": 1.5,
        "acceleration.end": 7.0,
        "deceleration": 3.0,
        "deceleration.start": 9.5,
        "deceleration.end": 15.0,
    }
)
