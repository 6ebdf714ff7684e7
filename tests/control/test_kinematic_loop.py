"""HighLevelLqr with ReferenceTrajectory on a planar car that obeys every command at once."""

from __future__ import annotations

import numpy as np
import pytest

from fmukit.direct import Direct
from fmus.controllers.high_level_lqr import COMPONENT
from fmus.controllers.reference import COMPONENT as REFERENCE

INSTANT = {f"actuator.filter.{name}": 1e6 for name in ("speed", "yaw_rate", "steering")} | {
    "actuator.steering.filter_time": 0.0,
    "actuator.sample_period": 0.0,
}


def drive(offset: float, stop: float) -> np.ndarray:
    """Rows of lateral, longitudinal and yaw error of a kinematic car that starts `offset` to the left.

    Its sideslip is the one the feed-forward expects, so that course = yaw + sideslip.
    """
    player, controller = Direct(REFERENCE), Direct(COMPONENT, INSTANT)
    player.sample()
    x, y, psi, v = 0.0, offset, 0.0, player["reference.speed"]
    rows, h = [], 0.020 / 20
    for _ in range(round(stop / 0.020)):
        controller.set(player.outputs() | {"estimate.position.x": x, "estimate.position.y": y, "estimate.yaw": psi})
        beta = controller["feedforward.sideslip"]
        controller.set({"estimate.velocity.x": v * np.cos(beta), "estimate.velocity.y": v * np.sin(beta)})
        controller.sample()
        rows.append([controller[f"error.{name}"] for name in ("lateral", "longitudinal", "yaw")])
        beta, omega, a = (controller[n] for n in ("feedforward.sideslip", "command.yaw_rate", "command.acceleration"))
        for _ in range(20):
            x, y = x + h * v * np.cos(psi + beta), y + h * v * np.sin(psi + beta)
            psi, v = psi + h * omega, v + h * a
        player.sample()
    return np.array(rows)


def test_an_offset_decays_along_the_manoeuvre() -> None:
    rows = drive(0.5, 12.0)
    assert rows[0, 0] == pytest.approx(0.5)
    late = np.abs(rows[250:])
    assert late[:, 0].max() < 0.05
    assert late[:, 1].max() < 0.10


def test_feedback_pulls_towards_the_path_from_both_sides() -> None:
    left, right = drive(0.5, 2.0), drive(-0.5, 2.0)
    np.testing.assert_allclose(left[:, 0], -right[:, 0], atol=1e-3)
    assert left[75, 0] < 0.25
