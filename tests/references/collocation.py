"""The double lane change by another method: Radau collocation on equal times, written down without the planner."""

from __future__ import annotations

import casadi as ca
import numpy as np

from fmus.cars.single_track import SingleTrackCar
from fmus.planner.road import Corridor
from fmus.single_track import model

DEGREE = 3
_SCALE = np.array([10, 1, 10, 0.1, 0.1, 0.3, 0.1])
_INPUT_SCALE = np.array([0.5, 5e3, 5e3])
_LOW = np.array([-30, -np.inf, 3, -0.5, -np.inf, -np.inf, -0.6])
_HIGH = np.array([140, np.inf, 60, 0.5, np.inf, np.inf, 0.6])


def final_time(car: SingleTrackCar, road: Corridor, m: int) -> float:
    """The least end time [s]: states are polynomials of degree 3 on every interval, inputs constant, no smoothing."""
    f, limits = model.function(car), road.limits()
    derivative, _, _ = ca.collocation_coeff(ca.collocation_points(DEGREE, "radau"))
    X, U, t_f = ca.MX.sym("X", 7, DEGREE * m + 1), ca.MX.sym("U", 3, m), ca.MX.sym("t_f")
    x = ca.diag(_SCALE) @ X
    starts, inside = x[:, :-1:DEGREE], [x[:, j::DEGREE] for j in range(1, DEGREE + 1)]
    g = []
    for j in range(DEGREE):
        slope = sum(derivative[i, j] * part for i, part in enumerate([starts, *inside]))
        motion = f.map(m)(inside[j], ca.diag(_INPUT_SCALE) @ U)
        g.append(ca.vec(ca.diag(1 / _SCALE) @ (slope - t_f / m * motion)))
    equal = sum(part.numel() for part in g)
    low, high = limits.map(m + 1)(x[0, ::DEGREE])
    g += [ca.vec(low - x[1, ::DEGREE]), ca.vec(x[1, ::DEGREE] - high)]
    solver = ca.nlpsol(
        "radau",
        "ipopt",
        {"x": ca.veccat(X, U, t_f), "f": t_f, "g": ca.vertcat(*g)},
        {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "mu_strategy": "adaptive"}},
    )
    bottom, top = (np.tile(bound[:, None], DEGREE * m + 1) for bound in (_LOW, _HIGH))
    bottom[[0, 2, 3, 4, 5, 6], 0] = top[[0, 2, 3, 4, 5, 6], 0] = [-30, 10, 0, 0, 0, 0]
    bottom[[0, 4], -1] = top[[0, 4], -1] = [140, 0]
    least = np.concatenate([np.zeros(equal), np.full(2 * (m + 1), -np.inf)])
    found = solver(
        x0=_column(_guess(road, DEGREE * m + 1), np.tile([0, 0, 2500.0], (m, 1)).T, 7.5),
        lbx=_column(bottom, np.tile([-0.5, -1e4, -5e3], (m, 1)).T, 1.0),
        ubx=_column(top, np.tile([0.5, 0, 5e3], (m, 1)).T, 60.0),
        lbg=least,
        ubg=0,
    )
    if not solver.stats()["success"]:
        raise RuntimeError(solver.stats()["return_status"])
    return float(found["f"])


def _column(x: np.ndarray, u: np.ndarray, t_f: float) -> np.ndarray:
    return np.concatenate([(x / _SCALE[:, None]).ravel("F"), (u / _INPUT_SCALE[:, None]).ravel("F"), [t_f]])


def _guess(road: Corridor, n: int) -> np.ndarray:
    """Mid-corridor, gaining speed evenly."""
    x = np.zeros((7, n))
    x[0], x[2] = np.linspace(-30, 140, n), np.linspace(10, 32, n)
    low, high = (bound.full().ravel() for bound in road.limits().map(n)(x[0][None, :]))
    x[1] = 0.5 * (low + high)
    x[4] = np.arctan(np.gradient(x[1], x[0]))
    return x
