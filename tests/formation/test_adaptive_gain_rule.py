"""The gain rule F <= K^2/(2 (1 + N2/4)): why it is one, and how one who breaks it gets to know."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from adaptive_loop import simulate

from cosim.command.main import main
from fmukit.direct import Direct
from fmus.controllers.adaptive_follower import COMPONENT

NEURONS = 10


@pytest.mark.parametrize("K", [0.5, 2.0, 3.0])
def test_the_rule_is_looked_at_before_the_first_sample(K):
    most = K**2 / (2 * (1 + NEURONS / 4))
    for share, broken in ((0.999, 0.0), (1.0, 0.0), (1.001, 1.0)):
        follower = Direct(COMPONENT, {"gain": K, "adaptation.output": share * most})
        assert follower["gain_rule.broken"] == broken
        follower.sample()
        assert follower["gain_rule.broken"] == broken


def test_start_values_keep_the_rule():
    assert Direct(COMPONENT)["gain_rule.broken"] == 0.0


def overshoot(F: float) -> float:
    """Largest swing back after a leader gained 2 m/s at once, relative to the first swing."""
    run = simulate(
        speed=lambda t: 20.0 if t < 2 else 22.0,
        yaw_rate=lambda t: 0.0,
        duration=12.0,
        parameters={"adaptation.output": F, "adaptation.hidden": 0.0},
    )
    return float(run.z[:, 0].max() / -run.z[:, 0].min())


def test_the_rule_is_what_keeps_the_loop_damped():
    """e'' + K e' + F |sigma|^2 e = 0: damping 0.7 at the rule gives 5 % back swing, damping 0.2 more than half."""
    assert overshoot(0.57) < 0.1
    assert overshoot(8.0) > 0.4
    assert np.isfinite(overshoot(200.0))


def test_a_broken_rule_is_told_once_on_stderr_and_the_run_goes_on(tmp_path, monkeypatch, capsys):
    settings = {"scenario.plant": "unicycle", "scenario.vehicles": "3"}
    settings |= {f"car{k}.follower.adaptation.output": "5" for k in (2, 3)}
    chosen = [word for name, value in settings.items() for word in ("--set", f"{name}={value}")]
    monkeypatch.setattr(
        sys, "argv", ["cosim", "run", "formation-adaptive", "--stop-time", "0.2", "-o", str(tmp_path), *chosen]
    )
    with pytest.raises(SystemExit) as exit_:
        main()
    told = [line for line in capsys.readouterr().err.splitlines() if "adaptation" in line]
    assert not exit_.value.code
    assert len(told) == 1
    assert told[0].startswith("cosim: car2.follower, car3.follower: adaptation.output (F) = 5 is too large for gain")
    assert "choose F <= K^2/7" in told[0]
