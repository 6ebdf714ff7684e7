"""DoubleTrack: away from rest, a steering pulse to the left, then braking to rest."""

from __future__ import annotations

from fmukit.reference_run import ReferenceRun, rise
from fmus.cars.wheels import WHEELS

_DRIVE, _BRAKE, _STEER = 300.0, 500.0, 0.03


def _inputs(t: float) -> dict[str, float]:
    """Torques [N.m] and steering angle [rad] at time t [s]."""
    drive = _DRIVE * (rise(t, 0.5, 0.2) - rise(t, 5.0, 0.2))
    steer = _STEER * (rise(t, 5.5, 0.3) - rise(t, 7.5, 0.3))
    brake = _BRAKE * rise(t, 9.0, 0.2)
    return {
        **{f"wheel_torque.{wheel}": drive for wheel in WHEELS},
        **{f"brake_torque.{wheel}": brake for wheel in WHEELS},
        "command.steer_angle": steer,
    }


RUN = ReferenceRun(
    "The car drives away from rest with the same torque on all wheels, steers left and back, and brakes to rest.",
    stop=13.0,
    step=0.02,
    inputs=_inputs,
    plots={
        "Velocity of O1": ("velocity.x", "velocity.y"),
        "Angular rate": ("angular_rate.z",),
        "Sideslip and steering": ("sideslip", "steer_angle.fl"),
        "Normal force of the tyres": tuple(f"tyre_force_z.{wheel}" for wheel in WHEELS),
    },
)
