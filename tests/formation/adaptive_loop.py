"""A leader on given speed and yaw rate, and a unicycle that AdaptiveFollower drives: numpy and closed forms only."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fmukit.direct import Direct
from fmus.controllers.adaptive_follower import COMPONENT
from tests.references import loop
from tests.references.loop import recorded, rotation

KERNEL = COMPONENT.kernel()
T, SUBSTEPS = 0.02, 4
Motion = Callable[[float], float]
Message = Mapping[str, float]


@dataclass
class Unicycle:
    """v' = (v_c - v)/lag, w' = (w_c - w)/lag; a lag of 0 follows at once."""

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0
    v: float = 0.0
    w: float = 0.0

    def drive(self, v_c: float, w_c: float, lag: float, dt: float) -> None:
        """Exact in v and w; the pose by the midpoint rule."""
        kept = np.exp(-dt / lag) if lag > 0 else 0.0
        v, w = v_c + kept * (self.v - v_c), w_c + kept * (self.w - w_c)
        mean_v, mean_w = (0.5 * (v + self.v), 0.5 * (w + self.w)) if lag > 0 else (v, w)
        course = self.yaw + 0.5 * mean_w * dt
        self.x += dt * mean_v * np.cos(course)
        self.y += dt * mean_v * np.sin(course)
        self.yaw += dt * mean_w
        self.v, self.w = v, w

    def place(self, r: np.ndarray) -> np.ndarray:
        return np.array([self.x, self.y]) + rotation(self.yaw) @ r


def pose(car: Unicycle) -> dict[str, float]:
    return loop.pose("leader", car.x, car.y, car.yaw)


def estimate(car: Unicycle) -> dict[str, float]:
    return loop.motion("estimate", car.x, car.y, car.yaw, car.v, car.w)


@dataclass(frozen=True)
class Run:
    """Per sample: time [s], true error of the hand point in the follower's axes [m], and the follower's outputs."""

    time: np.ndarray
    z: np.ndarray
    outputs: dict[str, np.ndarray]
    follower: Direct

    def distance(self, after: float = 0.0) -> np.ndarray:
        return np.hypot(*self.z[self.time >= after].T)

    def rms(self, after: float = 0.0) -> float:
        return float(np.sqrt(np.mean(self.distance(after) ** 2)))


def simulate(
    *,
    speed: Motion,
    yaw_rate: Motion,
    r: tuple[float, float] = (-12.0, 4.0),
    duration: float = 60.0,
    lag: float = 0.0,
    start: tuple[float, float] = (0.0, 0.0),
    parameters: Mapping[str, float] | None = None,
    hear: Callable[[int, Unicycle], Message] | None = None,
    inputs: Callable[[float], Message] = lambda t: {},
) -> Run:
    """The follower starts with the leader's speed and yaw, `start` [m] away from its place.

    `hear(k, leader)` gives the inputs leader.* at sample k; by default they are the leader's pose now.
    """
    leader = Unicycle(v=speed(0.0), w=yaw_rate(0.0))
    x, y = np.add(r, start)
    car = Unicycle(x=x, y=y, v=speed(0.0))
    follower = Direct(COMPONENT, parameters or {}, kernel=KERNEL)
    a = follower.p[follower.interface.names("parameter").index("hand.distance")]

    def step(k: int) -> dict[str, Any]:
        now = {"formation.x": r[0], "formation.y": r[1], **inputs(k * T)}
        follower.set({**now, **estimate(car), **(hear(k, leader) if hear else pose(leader))})
        follower.sample()
        wanted = leader.place(np.array([follower["offset.x"] + a, follower["offset.y"]]))
        z = rotation(car.yaw).T @ (car.place(np.array([a, 0.0])) - wanted)
        for j in range(SUBSTEPS):
            t, dt = k * T + j * T / SUBSTEPS, T / SUBSTEPS
            leader.drive(speed(t + dt / 2), yaw_rate(t + dt / 2), 0.0, dt)
            car.drive(follower["command.speed"], follower["command.yaw_rate"], lag, dt)
        return follower.outputs() | {"z": z}

    outputs = recorded(step, round(duration / T))
    z = outputs.pop("z")
    return Run(T * np.arange(len(z)), z, outputs, follower)
