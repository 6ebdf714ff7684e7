"""From the parameters to what the filter assumes: noises, trust, places and the prior."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Parts, Signals, block, slots
from fmus.cars.rotation import rotation_plane
from fmus.estimator.attitude import load_spread
from fmus.estimator.interface import INTERFACE
from fmus.estimator.navigation import STATE, pack
from fmus.estimator.records import ASSUMED

_PARAMETERS = slots(INTERFACE, "parameter")
_WALKS = {
    "gyroscope": "noise.gyroscope",
    "gyroscope_bias": "noise.gyroscope_bias",
    "accelerometer": "noise.accelerometer",
    "accelerometer_bias": "noise.accelerometer_bias",
    "gps_error": "noise.gps_correlated",
    "lean": "noise.attitude_lean",
}


@block(p=_PARAMETERS)
def assumptions(p: Signals) -> ca.SX:
    """The column of ASSUMED."""
    T, unit = p["sample_period"], p.vector("imu.position", AXES)
    rear = ca.vertcat(-p["design.rear_axle"], 0, 0)
    course = {
        "used": p["course.used"],
        "sideslip": p["course.sideslip"] ** 2,
        "rate": p["course.yaw_rate"],
        "force": p["course.acceleration"],
        "speed": p["course.speed"],
    }
    return ASSUMED.join(
        {
            "period": T,
            "process": {name: p[n] ** 2 for name, n in _WALKS.items()}
            | {"gps_decay": 1 / p["noise.gps_correlation_time"]},
            "tilt": p["noise.attitude"] ** 2 / T,
            "gates": {name: p[f"gate.{name}"] for name in ("heading", "position", "velocity")},
            "course": course,
            "rolling": _rolling(p),
            "arms": {"antenna": p.vector("antenna.position", AXES) - unit, "rear": rear - unit},
            "initial": pack(ca.diag(_spread(p) ** 2)),
        }
    )


def _rolling(p: Signals) -> Parts:
    """Slow errors count by their variance times correlation time over sampling period."""
    count, compliance = p["wheels.correlation_time"] / p["sample_period"], p["design.rear_compliance"]
    return {
        "used": p["wheels.used"],
        "speed": count * p["wheels.slip"] ** 2,
        "sideslip": count * p["wheels.sideslip"] ** 2,
        "slope": count * (p["wheels.compliance_error"] * compliance) ** 2,
        "floor": count * p["wheels.floor"] ** 2,
        "compliance": compliance,
    }


def _spread(p: Signals) -> ca.SX:
    """Standard deviations of the states at the start."""
    lean, share = load_spread(p)
    std = {name: p[f"initial.std.{n}"] for name, n in _STARTS.items()}
    parts = {name: ca.repmat(value, STATE.sizes[name]) for name, value in std.items()}
    rest = {"gps_error": ca.repmat(p["noise.gps_correlated"], 2), "load_lean": lean, "load_share": share}
    column: ca.SX = STATE.join(parts | rest)
    return column


_STARTS = {
    "heading": "yaw",
    "position": "position",
    "velocity": "velocity",
    "tilt": "attitude",
    "gyroscope_bias": "gyroscope_bias",
    "accelerometer_bias": "accelerometer_bias",
}


@block(p=_PARAMETERS)
def prior(p: Signals) -> ca.SX:
    """Belief about the inertial unit at the start, level and without yaw rate, as a column of BELIEF."""
    psi, lever = p["initial.yaw"], p.vector("imu.position", "xy")
    position = p.vector("initial.position", "xy") + rotation_plane(psi) @ lever
    mean = {"heading": psi, "position": position, "velocity": ca.vertcat(p["initial.speed"], 0)}
    return ca.vertcat(STATE.begun(mean), ASSUMED.split(assumptions(p))["initial"])
