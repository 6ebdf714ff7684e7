"""Feed-forward by stable inversion, against the single-track vehicle simulated by scipy."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmukit.direct import Direct
from fmus.cars.nominal import DESIGN
from fmus.controllers.high_level_lqr import COMPONENT, leads
from fmus.controllers.low_level_pid import COMPONENT as LOW_LEVEL
from fmus.controllers.reference import COMPONENT as REFERENCE

M, I_ZZ, C_F, C_R = DESIGN.mass, DESIGN.yaw_inertia, DESIGN.cornering_front, DESIGN.cornering_rear
L_F, L_R = DESIGN.l_f - DESIGN.pneumatic_trail, DESIGN.l_r + DESIGN.pneumatic_trail


NO_FEEDBACK = {f"weight.{name}": 0.0 for name in ("longitudinal", "speed", "lateral", "yaw")} | {
    "integral.longitudinal": 0.0,
    "integral.lateral": 0.0,
}
FILTERS = [f"actuator.filter.{name}" for name in ("speed", "yaw_rate", "steering")]
INSTANT = dict.fromkeys(FILTERS, 1e6) | {"actuator.steering.filter_time": 0.0, "actuator.sample_period": 0.0}
"""Leaves a lead of half a sampling period: a held command is that late on average."""


def axle_forces(z: np.ndarray, v: float, delta: float) -> tuple[float, float]:
    """Lateral forces of the linear single-track without relaxation at z = (beta, r)."""
    return C_F * (delta - z[0] - L_F * z[1] / v), -C_R * (z[0] - L_R * z[1] / v)


def single_track(z: np.ndarray, v: float, delta: float) -> list[float]:
    F_F, F_R = axle_forces(z, v, delta)
    return [(F_F + F_R) / (M * v) - z[1], (L_F * F_F - L_R * F_R) / I_ZZ]


def drive(z: np.ndarray, delta: float, duration: float) -> np.ndarray:
    """State of the single-track at 30 m/s after `duration` with the steering angle held."""
    return solve_ivp(lambda _, s: single_track(s, 30.0, delta), (0.0, duration), z, rtol=1e-8, atol=1e-10).y[:, -1]


def steer(period: float, stop: float, **parameters: float) -> list[dict[str, float]]:
    """Commands of the feed-forward along the lateral manoeuvre at 30 m/s, with the reference beside them."""
    straight = {"initial_speed": 30.0, "acceleration": 0.0, "deceleration": 0.0}
    player = Direct(REFERENCE, straight)
    controller = Direct(COMPONENT, {"sample_period": period, **NO_FEEDBACK, **parameters})
    rows = []
    for _ in range(round(stop / period)):
        player.sample(period)
        controller.set(player.outputs())
        controller.sample(period)
        rows.append(controller.outputs() | {"a_y": player["reference.speed"] ** 2 * player["reference.curvature"]})
    return rows


def test_single_track_reproduces_the_lateral_acceleration() -> None:
    period = 0.005
    rows = steer(period, 6.0, **INSTANT, **{"design.relaxation_length": 0.0})
    z, seen = np.zeros(2), []
    for row in rows:
        delta = row["command.steer_feedforward"]
        seen.append([sum(axle_forces(z, 30.0, delta)) / M, *z])
        z = drive(z, delta, period)
    a_y, beta, r = np.array(seen).T
    np.testing.assert_allclose(a_y, [row["a_y"] for row in rows], atol=0.04)
    np.testing.assert_allclose(beta, [row["feedforward.sideslip"] for row in rows], atol=2e-4)
    np.testing.assert_allclose(r, [row["feedforward.yaw_rate"] for row in rows], atol=1e-3)
    assert np.abs(a_y).max() > 3.9


def test_relaxation_of_the_front_tyre_is_made_up_for() -> None:
    """The angle grows by sigma / v times the rate of the front slip angle, here by finite differences.

    Angles are half a period ahead of the sideslip and yaw rate beside them, which are therefore taken in the middle.
    """
    period, sigma = 0.01, 0.4
    plain, ahead = (steer(period, 5.0, **INSTANT, **{"design.relaxation_length": s}) for s in (0.0, sigma))

    def column(rows: list[dict[str, float]], name: str) -> np.ndarray:
        return np.array([row[name] for row in rows])

    def middle(name: str) -> np.ndarray:
        return 0.5 * (column(plain, name)[1:] + column(plain, name)[:-1])

    delta = column(plain, "command.steer_feedforward")[:-1]
    slip = delta - middle("feedforward.sideslip") - L_F / 30.0 * middle("feedforward.yaw_rate")
    extra = column(ahead, "command.steer_feedforward")[:-1] - delta
    np.testing.assert_allclose(extra, sigma / 30.0 * np.gradient(slip, period), atol=6e-5)
    assert np.abs(extra).max() > 1e-3


@pytest.mark.parametrize("v", [10.0, 20.0, 35.0])
def test_steady_cornering_has_the_understeer_of_the_single_track(v: float) -> None:
    curvature = 3.0 / v**2
    bus = {"reference.speed": v, "reference.curvature": curvature, "reference.yaw_rate": v * curvature}
    for k in range(1, 61):
        bus |= {f"preview[{k}].speed": v, f"preview[{k}].curvature": curvature}
    controller = Direct(COMPONENT, NO_FEEDBACK)
    controller.set(bus | {"estimate.velocity.x": v})
    for _ in range(1500):
        controller.sample()
    L = L_F + L_R
    gradient = M / L * (L_R / C_F - L_F / C_R)  # rad per m/s2
    assert controller["command.steer_feedforward"] == pytest.approx(L * curvature + gradient * 3.0, rel=1e-6)
    assert controller["command.yaw_rate"] == pytest.approx(v * curvature, rel=1e-6)
    beta = L_R * curvature - M * 3.0 * L_F / (L * C_R)
    assert controller["feedforward.sideslip"] == pytest.approx(beta, rel=1e-6)


@pytest.mark.parametrize("slow", [dict.fromkeys(FILTERS, 150.0), {"actuator.sample_period": 0.02}])
def test_leads_take_the_commands_ahead(slow: dict[str, float]) -> None:
    """With actuators one period later, 3/omega or a period of their own, commands are those of one sample later."""
    now, ahead = steer(0.02, 8.0, **INSTANT), steer(0.02, 8.0, **INSTANT | slow)
    for name, tolerance in (("command.steer_feedforward", 4e-5), ("command.yaw_rate", 1e-5), ("command.speed", 1e-9)):
        early, late = (np.array([row[name] for row in rows]) for rows in (ahead, now))
        np.testing.assert_allclose(early[:-1], late[1:], atol=tolerance)


def test_leads_are_the_delays_of_the_low_level_controller_as_it_starts() -> None:
    theirs = {v.name: float(v.start) for v in LOW_LEVEL.interface.select("parameter")}
    ours = {v.name: float(v.start) for v in COMPONENT.interface.select("parameter")} | {"sample_period": 0.03}
    sampling = 0.015 + theirs["sample_period"]
    expected = {
        leads.speed: 3 / theirs["filter.speed"] + sampling,
        leads.yaw_rate: 3 / theirs["filter.yaw_rate"] + sampling,
        leads.steering: 3 / theirs["filter.steering"] + theirs["steering.filter_time"] + sampling,
    }
    for lead, value in expected.items():
        assert float(ca.DM(lead({name: ca.SX(start) for name, start in ours.items()}))) == pytest.approx(value)


def test_standing_still_gives_finite_commands() -> None:
    controller = Direct(COMPONENT)
    controller.set({"reference.curvature": 0.05, **{f"preview[{k}].curvature": 0.05 for k in range(1, 61)}})
    for _ in range(100):
        controller.sample()
    assert np.all(np.isfinite(controller.y))
    assert controller["command.speed"] == 0.0
    assert controller["command.yaw_rate"] == pytest.approx(0.0, abs=1e-12)
