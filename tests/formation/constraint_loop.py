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
        c, n = np.cos(s[2]), np.sin(s[2])
        return np.array([s[3] * c - s[5] * n, s[3] * n + s[5] * c, s[4], dv + push[0], dw, push[1]])


def estimate(state: np.ndarray) -> Values:
    x, y, yaw, v, w, slide = state
    return {
        "estimate.velocity.y": slide,
        "estimate.position.x": x,
        "estimate.position.y": y,
        "estimate.yaw": yaw,
        "estimate.velocity.x": v,
        "estimate.yaw_rate": w,
    }


def message(state: np.ndarray | tuple[float, ...], age: float = 0.0) -> Values:
    x, y, yaw, v, w, slide = (*state, 0.0)[:6]
    return {
        "leader.velocity.y": slide,
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
    outputs: list[Values]

    def __getitem__(self, name: str) -> np.ndarray:
        return np.array([y[name] for y in self.outputs])

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
    follower, vehicle = Follower(**parameters), Vehicle(np.array(start, float), lag)
    states, outputs = [], []
    for k in range(round(seconds / T)):
        t = k * T
        r = place(t) if callable(place) else place
        heard = radio(t) if radio else message(leader(t))
        y = follower.step(heard | estimate(vehicle.state) | {"formation.x": r[0], "formation.y": r[1]} | inputs(t))
        vehicle.drive(y)
        states.append(leader(t))
        outputs.append(y)
    return Run(np.array(vehicle.rows), np.array(states), outputs)
