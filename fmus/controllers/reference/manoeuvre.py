"""The built-in manoeuvre: pulses of tangential and lateral acceleration with quintic flanks, integrated to a path."""

from __future__ import annotations

import casadi as ca

from fmukit.integration import rk4
from fmukit.kernel import Signals, block, slots
from fmus.clip import clip
from fmus.controllers.reference.interface import INTERFACE

STEP = 0.01
_SLOWEST = 1.0  # m/s; below it the lateral acceleration fades with the speed, so that the curvature stays bounded
_WEAVE = (1.0, -1.0, -1.0, 1.0)


def blend(xi: ca.SX) -> ca.SX:
    """s(xi) = xi^3 (10 - 15 xi + 6 xi^2), 0 before 0 and 1 after 1; twice continuously differentiable."""
    xi = clip(xi, 0, 1)
    return xi**3 * (10 - 15 * xi + 6 * xi**2)


def blend_integral(xi: ca.SX) -> ca.SX:
    """The integral of `blend` from 0 to xi."""
    inside = clip(xi, 0, 1)
    return inside**4 * (2.5 - 3 * inside + inside**2) + ca.fmax(xi - 1, 0)


def pulse(t: ca.SX, start: ca.SX, end: ca.SX, rise: ca.SX) -> ca.SX:
    """1 between start + rise and end - rise, 0 outside (start, end)."""
    return blend((t - start) / rise) - blend((t - end + rise) / rise)


def pulse_integral(t: ca.SX, start: ca.SX, end: ca.SX, rise: ca.SX) -> ca.SX:
    """The integral of `pulse` from 0 to t, for start >= 0."""
    return rise * (blend_integral((t - start) / rise) - blend_integral((t - end + rise) / rise))


def motion(p: Signals, t: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Speed v [m/s], tangential acceleration [m/s2] and curvature [1/m] at time t [s]; the car never reverses."""
    up = [p[f"acceleration.{name}"] for name in ("start", "end", "rise")]
    down = [p[f"deceleration.{name}"] for name in ("start", "end", "rise")]
    gained = p["acceleration"] * pulse_integral(t, *up) - p["deceleration"] * pulse_integral(t, *down)
    rate = p["acceleration"] * pulse(t, *up) - p["deceleration"] * pulse(t, *down)
    v = p["initial_speed"] + gained
    moving = v >= 0
    v = ca.fmax(v, 0)
    return v, moving * rate, _lateral(p, t) / ca.fmax(v, _SLOWEST) ** 2


def _lateral(p: Signals, t: ca.SX) -> ca.SX:
    start, width, rise = p["weave.start"], p["weave.width"], p["weave.rise"]
    weave = sum(sign * pulse(t, start + k * width, start + (k + 1) * width, rise) for k, sign in enumerate(_WEAVE))
    turn = pulse(t, p["turn.start"], p["turn.end"], p["turn.rise"])
    return p["amplitude"] * (weave + p["turn.ratio"] * turn)


def path(p: Signals, rows: int) -> ca.MX:
    """The table (rows x 7) of time, x, y, course, speed, acceleration, curvature every STEP.

    x' = v cos(course), y' = v sin(course), course' = v curvature by the classical Runge-Kutta method.
    """
    half_steps = 2 * (rows - 1) + 1
    grid = ca.MX(ca.DM([0.5 * STEP * k for k in range(half_steps)]).T)
    moves = _moves.function.map("motions", "serial", half_steps, [0], [])(p.column, grid)
    begin, middle, end = moves[:, :-1:2], moves[:, 1::2], moves[:, 2::2]
    start = p.vector("initial", ("x", "y", "course"))
    later = _advance.function.mapaccum("path", rows - 1)(start, begin, middle, end)
    return ca.vertcat(grid[:, ::2], ca.horzcat(start, later), moves[:, ::2]).T


@block(p=slots(INTERFACE, "parameter"), t=1)
def _moves(p: Signals, t: ca.SX) -> ca.SX:
    return ca.vertcat(*motion(p, t))


@block(pose=3, begin=3, middle=3, end=3)
def _advance(pose: ca.SX, begin: ca.SX, middle: ca.SX, end: ca.SX) -> ca.SX:
    """(x, y, course) a STEP later, from the motion at the beginning, middle and end of the step."""
    moves: dict[float, ca.SX] = {0.0: begin, 0.5: middle, 1.0: end}

    def rate(z: ca.SX, part: float) -> ca.SX:
        v, _, curvature = ca.vertsplit(moves[part])
        return ca.vertcat(v * ca.cos(z[2]), v * ca.sin(z[2]), v * curvature)

    return rk4(rate, pose, STEP)
