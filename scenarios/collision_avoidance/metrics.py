"""How an encounter with an obstacle ended: clearance, impact, and what was decided on which grounds."""

from __future__ import annotations

import math

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from cosim.scenario.metric import Metric, Metrics, choice, in_unit, truth
from fmus.planner.evasion.decision import ACTIONS, Decision
from scenarios.collision_avoidance.evasion import Evasion
from scenarios.collision_avoidance.geometry import clearance, passed, road_margin
from scenarios.shared.mpc_metrics import solvers
from scenarios.shared.statistics import peak, rms
from scenarios.shared.tracking_errors import tracking_errors

_STANDING = 0.1
_BRAKES, _STEERS = 0.5, 0.002
"""Deceleration [m/s2], a little more than that of drag, and steering angle [rad] that count as an action."""


def avoidance_metrics(results: Results, planned: Evasion) -> Metrics:
    """What was decided, what happened, and how well the plan was tracked."""
    e = tracking_errors(results)
    return {
        **grounds(planned.decision),
        "first_action": Metric(first_action(results), "s"),
        **outcome(results, planned),
        "lateral_error_max": Metric(peak(e.lateral), "m"),
        "lateral_error_rms": Metric(rms(e.lateral), "m"),
        "longitudinal_error_max": Metric(peak(e.longitudinal), "m"),
        "speed_error_max": Metric(peak(e.speed), "m/s"),
        "sideslip_max": Metric(peak(results["plant.sideslip"]), "rad"),
        **solvers(results),
    }


def grounds(decided: Decision) -> Metrics:
    """The `decision` and what it was made from."""
    distances = {
        "distance_left": decided.left,
        "last_point_to_brake": decided.brake,
        "last_point_to_steer": decided.steer,
        "last_point_to_brake_and_steer": decided.brake_and_steer,
    }
    return {"decision": choice(decided.code, ACTIONS), **in_unit("m", distances)}


def outcome(results: Results, planned: Evasion) -> Metrics:
    """How it ended. The run goes on through the obstacle.

    `impact_speed` is the speed when the car first touches it, NaN if it never does. `impact` and `clearance_min` are
    NaN when the run ends before the car has touched or passed the obstacle or come to rest. `stop_distance` is the way
    to a standstill from where the obstacle appeared, NaN if the car keeps moving.
    """
    gap = clearance(results, planned)
    touched = np.flatnonzero(gap <= 0)
    speed = np.hypot(results["plant.velocity.x"], results["plant.velocity.y"])
    over = len(touched) > 0 or bool((speed < _STANDING).any()) or passed(results, planned)
    return {
        "clearance_min": Metric(float(gap.min()) if over else math.nan, "m"),
        "impact": truth(len(touched) > 0 if over else math.nan),
        "impact_speed": Metric(float(speed[touched[0]]) if len(touched) else math.nan, "m/s"),
        "impact_speed_expected": Metric(planned.decision.impact, "m/s"),
        "stop_distance": Metric(_stop_distance(results, speed), "m"),
        "road_margin_min": Metric(road_margin(results, planned.surroundings), "m"),
    }


def first_action(results: Results) -> float:
    """When [s] the car first brakes or steers after the obstacle appeared; NaN if it never does."""
    angle, rate = results["plant.steer_angle.fl"], results["plant.acceleration.x"]
    acts = np.flatnonzero((np.abs(angle) > _STEERS) | (rate < -_BRAKES))
    return float(results.time[acts[0]]) if len(acts) else math.nan


def _stop_distance(results: Results, speed: Vector) -> float:
    standing, x = np.flatnonzero(speed < _STANDING), results["plant.position.x"]
    return float(x[standing[0]] - x[0]) if len(standing) else math.nan
