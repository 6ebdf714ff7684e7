"""How an encounter with an obstacle ended: clearance, impact, and what was decided on which grounds."""

from __future__ import annotations

import math

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.collision_avoidance import loop
from scenarios.shared.mpc_metrics import solvers
from scenarios.shared.rectangles import footprint, separation
from scenarios.shared.tracking_errors import peak, rms, tracking_errors

_STANDING = 0.1
_BRAKES, _STEERS = 0.5, 0.002
"""Deceleration [m/s2], a little more than that of drag, and steering angle [rad] that count as an action."""


def avoidance_metrics(results: Results) -> dict[str, float]:
    """Metrics in SI units; `decision`: 0 brake, 1 steer, 2 brake and steer, 3 mitigate.

    The run goes on through the obstacle: `impact_speed` is the speed when the car first touches it, NaN if it never
    does. `impact` and `clearance_min` are NaN when the run ends before the car has touched or passed the obstacle or
    come to rest. `stop_distance` is the way to a standstill from where the obstacle appeared, NaN if the car keeps
    moving.
    """
    decided, e = loop.decision(results.settings), tracking_errors(results)
    gap = clearance(results)
    touched = np.flatnonzero(gap <= 0)
    speed = np.hypot(results["plant.velocity.x"], results["plant.velocity.y"])
    over = len(touched) > 0 or bool((speed < _STANDING).any()) or _passed(results)
    return {
        "decision": float(decided.code),
        "distance_left": decided.left,
        "last_point_to_brake": decided.brake,
        "last_point_to_steer": decided.steer,
        "last_point_to_brake_and_steer": decided.brake_and_steer,
        "first_action": first_action(results),
        "clearance_min": float(gap.min()) if over else math.nan,
        "impact": float(len(touched) > 0) if over else math.nan,
        "impact_speed": float(speed[touched[0]]) if len(touched) else math.nan,
        "impact_speed_expected": decided.impact,
        "stop_distance": _stop_distance(results, speed),
        "road_margin_min": road_margin(results),
        "lateral_error_max": peak(e.lateral),
        "lateral_error_rms": rms(e.lateral),
        "longitudinal_error_max": peak(e.longitudinal),
        "speed_error_max": peak(e.speed),
        "sideslip_max": peak(results["plant.sideslip"]),
        **solvers(results),
    }


def clearance(results: Results) -> Vector:
    """Distance [m] of the car from the obstacle over time, both as rectangles."""
    return separation(car(results), obstacle(results))


def first_action(results: Results) -> float:
    """When [s] the car first brakes or steers after the obstacle appeared; NaN if it never does."""
    angle, rate = results["plant.steer_angle.fl"], results["plant.acceleration.x"]
    acts = np.flatnonzero((np.abs(angle) > _STEERS) | (rate < -_BRAKES))
    return float(results.time[acts[0]]) if len(acts) else math.nan


def road_margin(results: Results) -> float:
    """Least distance [m] of the car's corners from the edges of the road; negative when it leaves the road."""
    from fmus.planner.evasion.situation import Surroundings  # noqa: PLC0415  (lazy: `cosim list`)

    s, y = Surroundings(), car(results)[:, :, 1]
    return float(min(y.min() + 0.5 * s.lane, 1.5 * s.lane - y.max()))


def car(results: Results) -> Vector:
    """The car's rectangles (n, 4, 2) [m]."""
    from fmus.planner.evasion.situation import Surroundings  # noqa: PLC0415

    s = Surroundings()
    x, y, yaw = (results[f"plant.{name}"] for name in ("position.x", "position.y", "yaw"))
    return footprint(x, y, yaw, s.front, s.rear, s.car_width)


def obstacle(results: Results) -> Vector:
    """The obstacle's rectangle (4, 2) [m]."""
    from fmus.planner.evasion.situation import Surroundings  # noqa: PLC0415

    met = loop.encounter(results.settings)
    place = np.array([Surroundings().front + met.distance]), np.zeros(1), np.zeros(1)
    return np.asarray(footprint(*place, met.length, 0.0, met.width)[0])


def _passed(results: Results) -> bool:
    """Whether the whole car is beyond the obstacle at the end."""
    return bool(car(results)[-1, :, 0].min() > obstacle(results)[:, 0].max())


def _stop_distance(results: Results, speed: Vector) -> float:
    standing = np.flatnonzero(speed < _STANDING)
    return (
        float(results["plant.position.x"][standing[0]] - results["plant.position.x"][0]) if len(standing) else math.nan
    )
