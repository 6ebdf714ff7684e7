"""LowLevelPid: commands of speed, yaw rate and roll, and a car that follows them late."""

from __future__ import annotations

from fmukit.reference_run import ReferenceRun, rise
from fmus.cars.nominal import DESIGN
from fmus.cars.wheels import WHEELS

_SPEED, _GAIN, _YAW_RATE, _STEER, _ROLL = 20.0, 4.0, 0.2, 0.03, 0.01
_DELAY = 0.05


def _command(t: float) -> dict[str, float]:
    """Speed [m/s], acceleration [m/s2], yaw rate [rad/s] and roll [rad] wanted at time t [s]."""
    xi = min(max((t - 0.5) / 2.0, 0.0), 1.0)
    return {
        "speed": _SPEED + _GAIN * rise(t, 0.5, 2.0),
        "acceleration": 30.0 * _GAIN / 2.0 * (xi * (1.0 - xi)) ** 2,
        "yaw_rate": _YAW_RATE * (rise(t, 1.5, 0.4) - rise(t, 3.5, 0.4)),
        "roll": _ROLL * rise(t, 3.0, 0.2),
    }


def _inputs(t: float) -> dict[str, float]:
    """Commands, and what the sensors of a car `_DELAY` behind them show, at time t [s]."""
    wanted, reached = _command(t), _command(t - _DELAY)
    steer = _STEER / _YAW_RATE * reached["yaw_rate"]
    return {
        **{f"command.{name}": value for name, value in wanted.items()},
        "command.steer_feedforward": _STEER / _YAW_RATE * wanted["yaw_rate"],
        "estimate.velocity.x": reached["speed"],
        "estimate.yaw_rate": reached["yaw_rate"],
        **{f"wheel_speed.{wheel}": reached["speed"] / DESIGN.rolling_radius for wheel in WHEELS},
        "steer_angle.fl": steer,
        "steer_angle.fr": steer,
    }


RUN = ReferenceRun(
    "More speed, then a turn, then some roll are commanded. The car measured is 0.05 s late with speed and yaw rate,"
    " steers less than demanded and does not roll, so the integrals run the actuators into their limits.",
    stop=5.0,
    step=0.01,
    inputs=_inputs,
    plots={
        "Motor torque": ("wheel_torque.fl", "wheel_torque.rl"),
        "Steering angle demanded": ("steer_demand",),
        "Steering torque": ("steer_torque.fl", "steer_torque.fr"),
        "Suspension force": tuple(f"suspension_force.{wheel}" for wheel in ("fl", "fr", "rl", "rr")),
        "Actuator limited": ("saturation.drive", "saturation.steering", "saturation.suspension"),
    },
)
