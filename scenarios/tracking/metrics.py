"""How well a car follows its reference and how good its estimate is, on true states of the plant at O1."""

from __future__ import annotations

import numpy as np

from cosim.results.reading import Results
from cosim.scenario.metric import Metric, Metrics
from scenarios.shared.statistics import mean, peak, rms
from scenarios.shared.tracking_errors import estimate_errors, longest_saturation, new_fixes, tracking_errors


def tracking_metrics(results: Results, _prepared: None) -> Metrics:
    """The metrics of a tracking run, its start included: an offset load starts leaning, as the passive car stands."""
    e, d = tracking_errors(results), estimate_errors(results)
    return {
        "lateral_error_max": Metric(peak(e.lateral), "m"),
        "lateral_error_rms": Metric(rms(e.lateral), "m"),
        "longitudinal_error_max": Metric(peak(e.longitudinal), "m"),
        "speed_error_max": Metric(peak(e.speed), "m/s"),
        "course_error_max": Metric(peak(e.course), "rad"),
        "roll_max": Metric(peak(results["plant.roll"]), "rad"),
        "pitch_max": Metric(peak(results["plant.pitch"]), "rad"),
        "sideslip_max": Metric(peak(results["plant.sideslip"]), "rad"),
        "position_estimate_rms": Metric(rms(np.hypot(d.x, d.y)), "m"),
        "yaw_estimate_rms": Metric(rms(d.yaw), "rad"),
        "nis_heading_mean": Metric(mean(new_fixes(results, "filter.nis.heading"))),
        "nis_position_mean": Metric(mean(new_fixes(results, "filter.nis.position"))),
        "nis_velocity_mean": Metric(mean(new_fixes(results, "filter.nis.velocity"))),
        "saturation_longest": Metric(longest_saturation(results), "s"),
    }
