"""The built-in manoeuvre: pulses of tangential and lateral acceleration with quintic flanks, integrated to a path."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Signals

STEP = 0.01
_SLOWEST = 1.0  # m/s; below it the lateral acceleration fades with the speed, so that the curvature stays bounded
_WEAVE = (1.0, -1.0, -1.0, 1.0)


def blend(xi: ca.SX) -> ca.SX:
    """s(xi) = xi^3 (10 - 15 xi + 6 xi^2), 0 before 0 and 1 after 1; twice continuously differentiable."""
    xi = ca.fmin(ca.fmax(xi, 0), 1)
    return xi**3 * (10 - 15 * xi + 6 * xi**2)


def blend_integral(xi: ca.SX) -> ca.SX:
    """The integral of `blend` from 0 to xi."""
    inside = ca.fmin(ca.fmax(xi, 0), 1)
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


def path(names: tuple[str, ...], rows: int) -> ca.Function:
    """p -> (rows x 7) table of time, x, y, course, speed, acceleration, curvature every STEP.

    x' = v cos(course), y' = v sin(course), course' = v curvature by the classical Runge-Kutta method.
    """
    p, t = ca.SX.sym("p", len(names)), ca.SX.sym("t")
    at = ca.Function("motion", [p, t], [ca.vertcat(*motion(Signals(names, p), t))])
    column = ca.MX.sym("p", len(names))
    half_steps = 2 * (rows - 1) + 1
    grid = ca.MX(ca.DM([0.5 * STEP * k for k in range(half_steps)]).T)
    moves = at.map("motions", "serial", half_steps, [0], [])(column, grid)
    begin, middle, end = moves[:, :-1:2], moves[:, 1::2], moves[:, 2::2]
    start = ca.vertcat(*(column[names.index(f"initial.{name}")] for name in ("x", "y", "course")))
    later = _advance().mapaccum("path", rows - 1)(start, begin, middle, end)
    pose = ca.horzcat(start, later)
    return ca.Function("manoeuvre", [column], [ca.vertcat(grid[:, ::2], pose, moves[:, ::2]).T])


def _advance() -> ca.Function:
    """One Runge-Kutta step of (x, y, course) from the motion at the beginning, middle and end of the step."""
    pose = ca.SX.sym("pose", 3)
    moves = [ca.SX.sym(f"motion{k}", 3) for k in range(3)]

    def rate(z: ca.SX, move: ca.SX) -> ca.SX:
        v, curvature = move[0], move[2]
        return ca.vertcat(v * ca.cos(z[2]), v * ca.sin(z[2]), v * curvature)

    k1 = rate(pose, moves[0])
    k2 = rate(pose + STEP / 2 * k1, moves[1])
    k3 = rate(pose + STEP / 2 * k2, moves[1])
    k4 = rate(pose + STEP * k3, moves[2])
    return ca.Function("advance", [pose, *moves], [pose + STEP / 6 * (k1 + 2 * k2 + 2 * k3 + k4)])
