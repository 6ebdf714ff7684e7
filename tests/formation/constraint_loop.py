"""ConstraintFollower on kinematic vehicles, and leaders in closed form: plain numpy, nothing of the components' motion.

A leader is a function of time giving (x, y, yaw, speed, yaw rate). Vehicles are integrated by the Runge-Kutta method
over each sample of 20 ms: v' and omega' either are the accelerations commanded, or follow the commands with a lag.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from fmus.controllers.constraint_follower.interface import INTERFACE
from fmus.controllers.constraint_follower.model import STATES, kernel

T = 0.02
A = 6.0
Values = dict[str, float]
Motion = Callable[[float], tuple[float, float, float, float, float]]


class Follower:
    """The kernel of the FMU with its state."""

    def __init__(self, **parameters: float) -> None:
        wanted = {v.name: float(v.start) for v in INTERFACE.select("parameter")} | {
            name.replace("__", "."): value for name, value in parameters.items()
        }
        self.names = INTERFACE.names("input")
        self.p = np.array([wanted[name] for name in INTERFACE.names("parameter")])
        self.start = {v.name: float(v.start) for v in INTERFACE.select("input")}
        assert len(wanted) == self.p.size, "unknown parameter"
        function = kernel().step
        self.u, self.x, self.y = np.zeros(len(self.names)), np.zeros(STATES.size), np.zeros(function.numel_out(1))
        self.later, empty, clock = np.zeros(STATES.size), np.zeros(0), np.zeros(1)
        self.buffer, self.run = function.buffer()
        self.kept = (self.p, empty, self.u, self.x, empty, clock)
        for k, array in enumerate(self.kept):
            self.buffer.set_arg(k, memoryview(array))
        self.buffer.set_res(0, memoryview(self.later))
        self.buffer.set_res(1, memoryview(self.y))

    def step(self, inputs: Values) -> Values:
        values = self.start | inputs
        assert len(values) == len(self.names), set(values) - set(self.names)
        self.u[:] = [values[name] for name in self.names]
        self.run()
        self.x[:] = self.later
        return dict(zip(INTERFACE.names("output"), self.y.tolist(), strict=True))


@dataclass
class Vehicle:
    """state (x, y, yaw, v, omega); `push` [m/s2] acts on the hand, along and across the vehicle."""

    state: np.ndarray
    lag: float | None = None
    rows: list[np.ndarray] = field(default_factory=list)

    def drive(self, y: Values, push: tuple[float, float] = (0.0, 0.0)) -> None:
        self.rows.append(self.state.copy())
        k1 = self._rates(self.state, y, push)
        k2 = self._rates(self.state + T / 2 * k1, y, push)
        k3 = self._rates(self.state + T / 2 * k2, y, push)
        k4 = self._rates(self.state + T * k3, y, push)
        self.state = self.state + T / 6 * (k1 + 2 * k2 + 2 * k3 + k4)

    def _rates(self, s: np.ndarray, y: Values, push: tuple[float, float]) -> np.ndarray:
        if self.lag is None:
            dv, dw = y["command.acceleration"], y["command.yaw_acceleration"]
        else:
            dv, dw = (y["command.speed"] - s[3]) / self.lag, (y["command.yaw_rate"] - s[4]) / self.lag
        return np.array([s[3] * np.cos(s[2]), s[3] * np.sin(s[2]), s[4], dv + push[0], dw + push[1] / A])


def estimate(state: np.ndarray) -> Values:
    x, y, yaw, v, w = state
    return {
        "estimate.position.x": x,
        "estimate.position.y": y,
        "estimate.yaw": yaw,
        "estimate.velocity.x": v,
        "estimate.yaw_rate": w,
    }


def message(state: np.ndarray | tuple[float, ...], age: float = 0.0) -> Values:
    x, y, yaw, v, w = state
    return {
        "leader.position.x": x,
        "leader.position.y": y,
        "leader.yaw": yaw,
        "leader.velocity.x": v,
        "leader.yaw_rate": w,
        "leader.age": age,
    }


def hand(state: np.ndarray) -> np.ndarray:
    return np.array([state[0] + A * np.cos(state[2]), state[1] + A * np.sin(state[2])])


def error(state: np.ndarray, leader: np.ndarray, r: tuple[float, float]) -> np.ndarray:
    """h - (h_L + R(psi_L) r) in world axes."""
    c, s = np.cos(leader[2]), np.sin(leader[2])
    return hand(state) - hand(leader) - np.array([[c, -s], [s, c]]) @ np.array(r)


def s_curve(speed: float = 20.0, rate: float = 0.12, period: float = 20.0) -> Motion:
    """A leader with omega = rate sin(2 pi t/period) at constant speed, integrated finely once."""
    h = 1e-3
    t = np.arange(0.0, 120.0, h)
    yaw = rate * period / (2 * np.pi) * (1 - np.cos(2 * np.pi * (t + h / 2) / period))
    x = np.concatenate([[0.0], np.cumsum(h * speed * np.cos(yaw))])
    y = np.concatenate([[0.0], np.cumsum(h * speed * np.sin(yaw))])

    def at(time: float) -> tuple[float, float, float, float, float]:
        k = round(time / h)
        w = rate * np.sin(2 * np.pi * time / period)
        psi = rate * period / (2 * np.pi) * (1 - np.cos(2 * np.pi * time / period))
        return float(x[k]), float(y[k]), float(psi), speed, float(w)

    return at
