"""ConstraintFollower on kinematic vehicles, and leaders in closed form: plain numpy, nothing of the components' motion.

A leader is a function of time giving (x, y, yaw, speed, yaw rate). Vehicles are integrated by the Runge-Kutta method
over each sample of 20 ms: v' and omega' either are the accelerations commanded, or follow the commands with a lag.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fmukit.integration import rk4
from fmus.controllers.constraint_follower import COMPONENT
from tests.references.loop import Sampled, Values, motion, recorded, rotation

T = 0.02
A = 6.0
Motion = Callable[[float], tuple[float, float, float, float, float]]


def follower(**parameters: float) -> Sampled:
    """The kernel of the FMU with its state."""
    return Sampled(COMPONENT, **parameters)


@dataclass
class Vehicle:
    """state (x, y, yaw, v, omega, slide), slide the speed to the left; `push` [m/s2] acts forward and to the left.

    Nothing but a push makes it slide, and nothing stops that: the hand answers to a push like a free mass.
    """

    state: np.ndarray
    lag: float | None = None
    rows: list[np.ndarray] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.state = np.append(self.state, np.zeros(6 - len(self.state)))

    def drive(self, y: Values, push: tuple[float, float] = (0.0, 0.0)) -> None:
        self.rows.append(self.state.copy())
        self.state = rk4(lambda state, _: self._rates(state, y, push), self.state, T)

    def _rates(self, s: np.ndarray, y: Values, push: tuple[float, float]) -> np.ndarray:
        if self.lag is None:
            dv, dw = y["command.acceleration"], y["command.yaw_acceleration"]
        else:
            dv, dw = (y["command.speed"] - s[3]) / self.lag, (y["command.yaw_rate"] - s[4]) / self.lag
        c, n = np.cos(s[2]), np.sin(s[2])
        return np.array([s[3] * c - s[5] * n, s[3] * n + s[5] * c, s[4], dv + push[0], dw, push[1]])


def estimate(state: np.ndarray) -> Values:
    return motion("estimate", *state)


def message(state: np.ndarray | tuple[float, ...], age: float = 0.0) -> Values:
    return motion("leader", *state) | {"leader.age": age}


def hand(state: np.ndarray) -> np.ndarray:
    return np.array([state[0] + A * np.cos(state[2]), state[1] + A * np.sin(state[2])])


def error(state: np.ndarray, leader: np.ndarray, r: tuple[float, float]) -> np.ndarray:
    """h - (h_L + R(psi_L) r) in world axes."""
    return hand(state) - hand(leader) - rotation(leader[2]) @ np.array(r)


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


def steady(speed: float = 20.0, rate: float = 0.0) -> Motion:
    """A leader on a straight or a circle, from the origin along x."""

    def at(t: float) -> tuple[float, float, float, float, float]:
        if rate == 0.0:
            return speed * t, 0.0, 0.0, speed, 0.0
        radius = speed / rate
        return radius * np.sin(rate * t), radius * (1.0 - np.cos(rate * t)), rate * t, speed, rate

    return at


def along_x(speed: Callable[[float], float], seconds: float) -> Motion:
    """A leader on the x axis whose speed is a function of time."""
    h = 1e-3
    v = np.array([speed(k * h) for k in range(round(seconds / h) + 2)])
    x = np.concatenate([[0.0], np.cumsum(h * 0.5 * (v[1:] + v[:-1]))])
    return lambda t: (float(x[round(t / h)]), 0.0, 0.0, float(v[round(t / h)]), 0.0)


class Radio:
    """Messages every 0.1 s, received 0.02 s later, with white noise; `lost(t)` says which are not received."""

    def __init__(self, leader: Motion, noise: float = 0.0, lost: Callable[[float], bool] = lambda t: False) -> None:
        self.leader, self.noise, self.lost, self.random = leader, noise, lost, np.random.default_rng(7)
        self.newest: tuple[float, np.ndarray] | None = None
        self.next = 0

    def __call__(self, t: float) -> Values:
        while 0.1 * self.next + 0.02 <= t + 1e-9:
            sent = 0.1 * self.next
            if not self.lost(sent):
                sigma = self.noise * np.array([0.03, 0.03, 0.003, 0.03, 0.003])
                self.newest = sent, np.array(self.leader(sent)) + sigma * self.random.normal(size=5)
            self.next += 1
        if self.newest is None:
            return {"leader.valid": 0.0, "leader.age": t}
        return message(self.newest[1], t - self.newest[0])


@dataclass
class Run:
    """What was recorded at every sample: own (n x 6) and leader's states (n x 5), outputs by name (n)."""

    own: np.ndarray
    leader: np.ndarray
    outputs: dict[str, np.ndarray]

    def __getitem__(self, name: str) -> np.ndarray:
        return self.outputs[name]

    def errors(self) -> np.ndarray:
        """Distance of the hand from the place wanted, for true states [m] (n)."""
        places = zip(self.own, self.leader, self["offset.x"], self["offset.y"], strict=True)
        return np.array([np.hypot(*error(own, leader, (x, y))) for own, leader, x, y in places])


def run(
    leader: Motion,
    start: tuple[float, ...],
    place: tuple[float, float] | Callable[[float], tuple[float, float]],
    seconds: float,
    *,
    lag: float | None = None,
    radio: Callable[[float], Values] | None = None,
    inputs: Callable[[float], Values] = lambda t: {},
    **parameters: float,
) -> Run:
    """One follower behind a leader; without a radio it knows the leader exactly, at every sample."""
    own, vehicle = follower(**parameters), Vehicle(np.array(start, float), lag)

    def step(k: int) -> dict[str, Any]:
        t = k * T
        r = place(t) if callable(place) else place
        heard = radio(t) if radio else message(leader(t))
        y = own.step(heard | estimate(vehicle.state) | {"formation.x": r[0], "formation.y": r[1]} | inputs(t))
        vehicle.drive(y)
        return y | {"leader": leader(t)}

    seen = recorded(step, round(seconds / T))
    return Run(np.array(vehicle.rows), seen.pop("leader"), seen)
