"""The straight and the constant-speed manoeuvre."""

from __future__ import annotations

import numpy as np
import pytest


def test_longitudinal_manoeuvre(scenario_run) -> None:
    finished = scenario_run("longitudinal-tracking")
    summary, results = finished.summary, finished.results
    v_x = results["plant.velocity.x"]
    assert v_x.max() == pytest.approx(30.0, abs=0.1)
    assert v_x[-1] == pytest.approx(15.0, abs=0.1)
    assert summary.metrics["lateral_error_max"].value <= 0.10
    assert summary.metrics["longitudinal_error_max"].value <= 0.10


def test_lateral_manoeuvre(scenario_run) -> None:
    finished = scenario_run("lateral-tracking")
    summary, results = finished.summary, finished.results
    speed = np.hypot(results["plant.velocity.x"], results["plant.velocity.y"])
    assert np.abs(speed - 30.0).max() <= 0.15
    assert summary.metrics["lateral_error_max"].value <= 0.15


@pytest.mark.parametrize("name", ["longitudinal-tracking", "lateral-tracking"])
def test_active_suspension_holds_roll_and_pitch(scenario_run, name) -> None:
    active, passive = (
        scenario_run(name, "scenario.feedback=truth", f"llc.suspension.enabled={on}").summary.metrics
        for on in ("true", "false")
    )
    key = "pitch_max" if name.startswith("longitudinal") else "roll_max"
    assert active[key].value < 0.3 * passive[key].value
