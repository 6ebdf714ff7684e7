"""The planar car that stands for Vehicle16Dof, against that car's own tyre and masses."""

from __future__ import annotations

import math

import casadi as ca
import pytest

from fmukit.interface import load_parameters
from fmus.design import DESIGN
from fmus.planner.hocp import Settings, plan
from fmus.planner.road import double_lane_change
from fmus.planner.vehicle import two_wheel_drive
from fmus.single_track.design import _PARAMETERS, design_car
from fmus.single_track.forces import lateral
from fmus.vehicle16dof import magic

PLANT = {v.name: float(v.start) for v in load_parameters(_PARAMETERS)}


def test_tyres_are_those_of_the_plant() -> None:
    k = {name.removeprefix("tyre."): value for name, value in PLANT.items() if name.startswith("tyre.")}
    car = design_car()
    for tyre, load in zip((car.front, car.rear), car.static_loads, strict=True):
        for alpha in (-0.2, 0.01, 0.05, 0.1):
            expected = -2 * magic.lateral(math, k, load / 2, 1.0, math.tan(alpha))
            assert float(lateral(tyre, ca.DM(alpha))) == pytest.approx(expected, rel=0.01)
    # softer than the static stiffness, because load transfer costs grip, but of the same size
    assert 0.8 < DESIGN.cornering_front / car.front.cornering_stiffness < 1.0
    assert 0.8 < DESIGN.cornering_rear / car.rear.cornering_stiffness < 1.0


def test_masses_and_loads() -> None:
    car = design_car()
    assert car.m == 1500.0 and car.I_zz == pytest.approx(2539, abs=1)
    assert sum(car.static_loads) == pytest.approx(1500.0 * PLANT["gravity"])
    assert car.understeer_gradient > 0


def test_it_can_be_planned() -> None:
    found = plan(two_wheel_drive(design_car()), double_lane_change(), 40, settings=Settings(compile=False))
    assert 6 < found.final_time < 9 and found.replay_error() < 0.01
