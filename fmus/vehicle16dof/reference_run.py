"""Vehicle16Dof: away from rest, then a steer torque to the left that is let go again, then braking."""

from __future__ import annotations

from fmukit.reference_run import ReferenceRun, rise
from fmus.cars.wheels import FRONT, WHEELS

_DRIVE, _BRAKE, _STEER = 400.0, 600.0, 25.0


def _inputs(t: float) -> dict[str, float]:
    """Torques [N.m] at time t [s]."""
    drive = _DRIVE * (rise(t, 0.5, 0.2) - rise(t, 5.0, 0.2))
    steer = _STEER * (rise(t, 5.5, 0.1) - rise(t, 7.5, 0.1))
    brake = _BRAKE * rise(t, 9.0, 0.2)
    return {
        **{f"wheel_torque.{wheel}": drive for wheel in WHEELS},
        **{f"brake_torque.{wheel}": brake for wheel in WHEELS},
        **{f"steer_torque.{wheel}": steer for wheel in FRONT},
    }


RUN = ReferenceRun(
    "The car drives away from rest with the same torque on all wheels, is steered to the left by a torque on both"
    " kingpins, let go, and braked.",
    stop=11.0,
    step=0.02,
    inputs=_inputs,
    plots={
        "Velocity of O1": ("velocity.x", "velocity.y"),
        "Angular rate": ("angular_rate.x", "angular_rate.z"),
        "Attitude and steering": ("roll", "pitch", "steer_angle.fl"),
        "Normal force of the tyres": tuple(f"tyre_force_z.{wheel}" for wheel in WHEELS),
    },
)
