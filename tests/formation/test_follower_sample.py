"""What every follower's sample begins and ends with."""

from __future__ import annotations

import importlib

import pytest

from fmukit.direct import Direct


@pytest.mark.parametrize("name", ["adaptive_follower", "constraint_follower"])
def test_a_first_sample_goes_on_as_the_car_drives(name):
    """Nothing is wrong, so nothing is commanded but what the car does: 17 m/s round a circle, in its place."""
    component = importlib.import_module(f"fmus.controllers.{name}").COMPONENT
    follower = Direct(component)
    motion = {"estimate.velocity.x": 17.0, "estimate.yaw_rate": 0.1, "estimate.position.x": -12.0}
    follower.set({**motion, "leader.valid": 0.0, "formation.x": -12.0})
    follower.sample()
    assert follower["link.lost"] == 1.0
    assert follower["command.speed"] == pytest.approx(17.0, abs=1e-9)
    assert follower["command.yaw_rate"] == pytest.approx(0.1 - 0.02 * 3.0, abs=1e-9)  # straight on, gently
    assert (follower["offset.x"], follower["offset.y"]) == (-12.0, 0.0)
    assert follower["saturation.yaw_rate"] == 1.0
    assert follower["saturation.speed"] == 0.0
