"""Tyre forces against published numbers and closed forms."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest

from fmukit.kernel import Signals, block, slots
from fmus.vehicle16dof import magic, tyre
from fmus.vehicle16dof.contact import Contact
from fmus.vehicle16dof.interface import INTERFACE

P = np.array([float(v.start) for v in INTERFACE.select("parameter")])
DATA = {v.name.removeprefix("tyre."): float(v.start) for v in INTERFACE.select("parameter")}


@pytest.fixture(scope="module")
def combined() -> ca.Function:
    @block(p=slots(INTERFACE, "parameter"), F_z=1, road=1, kappa=1, tangent=1)
    def combined(p: Signals, **arguments: ca.SX) -> tuple[ca.SX, ca.SX]:
        return tyre.combined(tyre.TyreData(p), **arguments)

    return combined.function


@pytest.mark.parametrize(
    ("kappa", "alpha", "F_x", "F_y"),
    [(0.1, 0.0, 4662.3, 0.0), (0.0, 0.102, 0.0, -3435.5), (0.1, 0.068, 3931.2, -2252.3)],
)
def test_forces_at_4_kN(combined: ca.Function, kappa: float, alpha: float, F_x: float, F_y: float) -> None:
    seen = [float(f) for f in combined(P, 4000.0, 1.0, kappa, math.tan(alpha))]
    assert seen == pytest.approx([F_x, F_y], abs=0.06)


@pytest.mark.parametrize(("F_z", "C"), [(4000.0, 46.0e3), (3270.0, 40.0e3), (4087.0, 46.6e3)])
def test_cornering_stiffness(combined: ca.Function, F_z: float, C: float) -> None:
    slope = -float(combined(P, F_z, 1.0, 0.0, 1e-6)[1]) / 1e-6
    assert slope == pytest.approx(C, abs=60.0)
    assert slope == pytest.approx(F_z * magic.lateral_stiffness(DATA, F_z), rel=1e-6)


def test_peaks(combined: ca.Function) -> None:
    slips = np.linspace(0.01, 0.6, 600)
    F_x = [float(combined(P, 4000.0, 1.0, s, 0.0)[0]) for s in slips]
    F_y = [-float(combined(P, 4000.0, 1.0, 0.0, s)[1]) for s in slips]
    assert max(F_x) / 4000 == pytest.approx(1.21, abs=2e-3)
    assert slips[np.argmax(F_x)] == pytest.approx(0.145, abs=3e-3)
    assert max(F_y) / 4000 == pytest.approx(0.99, abs=2e-3)
    assert math.degrees(math.atan(slips[np.argmax(F_y)])) == pytest.approx(14.5, abs=0.3)


def test_road_friction_scales_the_peak_and_keeps_the_stiffness(combined: ca.Function) -> None:
    dry = max(float(combined(P, 4000.0, 1.0, s, 0.0)[0]) for s in np.linspace(0, 1, 400))
    wet = max(float(combined(P, 4000.0, 0.3, s, 0.0)[0]) for s in np.linspace(0, 1, 400))
    assert wet == pytest.approx(0.3 * dry, rel=1e-3)
    slope = [float(combined(P, 4000.0, road, 1e-7, 0.0)[0]) for road in (1.0, 0.3)]
    assert slope[0] == pytest.approx(slope[1], rel=1e-5)


def test_no_force_and_no_nan_without_load(combined: ca.Function) -> None:
    assert [float(f) for f in combined(P, 0.0, 1.0, 0.3, -0.2)] == [0.0, 0.0]


@pytest.fixture(scope="module")
def slip_rates() -> ca.Function:
    @block(p=slots(INTERFACE, "parameter"), V_x=1, V_y=1, spin=1, kappa=1, tangent=1)
    def rates(p: Signals, V_x: ca.SX, V_y: ca.SX, spin: ca.SX, kappa: ca.SX, tangent: ca.SX) -> tuple[ca.SX, ca.SX]:
        none, zero = ca.SX(3, 1), ca.SX(0)
        touch = Contact(none, none, none, none, ca.SX(4000.0), V_x, V_y, zero, ca.SX(0.3), zero, zero)
        return tyre.slip_rates(tyre.TyreData(p), touch, spin, (kappa, tangent))

    return rates.function


def test_relaxation_settles_at_the_kinematic_slips_over_the_relaxation_lengths(slip_rates: ca.Function) -> None:
    V_x, V_y, spin = 20.0, 1.0, 70.0
    rates = [float(r) for r in slip_rates(P, V_x, V_y, spin, (spin * 0.3 - V_x) / V_x, V_y / V_x)]
    assert rates == pytest.approx([0.0, 0.0], abs=1e-12)
    rest = np.array([float(r) for r in slip_rates(P, V_x, V_y, spin, 0.0, 0.0)])
    assert rest == pytest.approx([(spin * 0.3 - V_x) / 0.30, V_y / 0.40])


def test_sliding_at_standstill_does_not_wind_up(slip_rates: ca.Function) -> None:
    bound = DATA["low_speed.slip"]
    along, across = (float(r) for r in slip_rates(P, 0.0, 2.0, 30.0, bound, bound))
    assert (along, across) == pytest.approx((0.0, 0.0), abs=1e-12)
