"""Any car goes from its parameters to the planar cars as the nominal one does, and interfaces do not pay for it."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import astuple, replace

import casadi as ca
import pytest

from fmus.cars import derived, published
from fmus.cars.double_track import double_track_car
from fmus.cars.grip import with_grip
from fmus.cars.multibody import assumed_car
from fmus.cars.nominal import DESIGN, plant_values
from fmus.cars.single_track import SingleTrackCar, Tyre
from fmus.planner.planned_cars import multibody
from fmus.single_track.forces import lateral
from tests.references.steady_turn import cornering_stiffness

_LIGHT = "import sys, fmus; print(*sorted({'numpy', 'scipy', 'casadi'} & sys.modules.keys()))"


def peak(tyre: Tyre) -> float:
    """Largest lateral force [N]."""
    return max(float(lateral(tyre, ca.DM(0.002 * k))) for k in range(300))


def numbers(car: SingleTrackCar) -> list[float]:
    *rest, front, rear, rolling = astuple(car)
    return [*rest, *front, *rear, *rolling]


def test_the_catalogue_is_light() -> None:
    done = subprocess.run([sys.executable, "-c", _LIGHT], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_another_car_goes_the_same_way() -> None:
    """300 kg more in the body, then tyres of 0.7 of the friction: the planar cars weigh and grip as that car does."""
    nominal, light = plant_values(), derived.single_track(DESIGN)
    other = assumed_car(nominal | {"body.mass": nominal["body.mass"] + 300.0})
    heavy = derived.single_track(other)
    assert other.mass == heavy.m == multibody(other).whole.planar.m == pytest.approx(DESIGN.mass + 300.0)
    assert 1.0 < peak(heavy.front) / peak(light.front) < other.mass / DESIGN.mass, "tyres grip less under more load"
    names = ("tyre.lateral.friction", "tyre.lateral.friction_load")
    wet = derived.single_track(assumed_car(nominal | {name: 0.7 * nominal[name] for name in names}))
    for before, after in ((light.front, wet.front), (light.rear, wet.rear)):
        assert peak(after) / peak(before) == pytest.approx(0.7, abs=0.03)


def test_parameters_by_name_are_those_of_the_double_track_car() -> None:
    values, whole = derived.double_track_values(DESIGN), derived.double_track(DESIGN)
    again = double_track_car(values | {"load.minimum": whole.least_load})
    assert numbers(again.planar) == pytest.approx(numbers(whole.planar), rel=1e-12)
    assert replace(again, planar=whole.planar) == whole


@pytest.mark.parametrize("part", [0.5, 1.0])
def test_part_of_the_grip(part: float) -> None:
    """The peak falls, the slope at small slip stays; a symbol gives the same."""
    car, mu = published.single_track(), ca.SX.sym("mu")
    less, symbolic = with_grip(car, part), with_grip(car, mu)
    for tyre, before, at in ((less.front, car.front, symbolic.front), (less.rear, car.rear, symbolic.rear)):
        assert part * before.D == tyre.D
        assert cornering_stiffness(tyre) == pytest.approx(cornering_stiffness(before))
        assert float(ca.evalf(ca.substitute(at.D, mu, part))) == tyre.D
