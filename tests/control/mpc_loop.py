"""The predictive controller in closed loop with the planar car, without FMUs; plans and inputs to play."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from fmukit.component import Component
from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus import double_track
from fmus.cars.wheels import WHEELS
from fmus.controllers import mpc_allocator, reference
from fmus.planner import plans, trajectory
from tests.references.loop import motion, recorded

PERIOD = 0.02
WHEEL_SPEEDS = tuple(f"wheel_speed.{wheel}" for wheel in WHEELS)
Hook = Callable[[float, Direct, Direct], None]
Array = np.ndarray


def nothing(t: float, mpc: Direct, plant: Direct) -> None:
    """Neither faults nor pushes."""


@cache
def kernel(component: Component) -> Kernel:
    made = component.kernel()
    assert isinstance(made, Kernel)
    return made


@cache
def lane_change() -> Array:
    """The time-optimal double lane change as a table."""
    return trajectory.table(plans.named("double-lane-change", 80, "gate", 10.0))


def driven(speed: Callable[[Array], Array], curvature: Callable[[Array], Array], duration: float) -> Array:
    """The table of a trajectory from rest at the origin's place, given by speed and curvature over time."""
    fine = np.linspace(0.0, duration, round(duration / 1e-3) + 1)
    v, kappa = speed(fine), curvature(fine)
    course = _integral(v * kappa, fine)
    x, y = _integral(v * np.cos(course), fine), _integral(v * np.sin(course), fine)
    return np.column_stack([fine, x, y, course, v, np.gradient(v, fine), kappa])[::20]


def _integral(f: Array, t: Array) -> Array:
    return np.concatenate([[0.0], np.cumsum(0.5 * (f[1:] + f[:-1]) * np.diff(t))])


@cache
def steady(speed: float, curvature: float, duration: float) -> Array:
    """From a straight onto a circle within half a second, at constant speed."""

    def bend(t: Array) -> Array:
        xi = np.clip(t / 0.5, 0.0, 1.0)
        return curvature * xi**3 * (10 - 15 * xi + 6 * xi**2)

    return driven(lambda t: np.full_like(t, speed), bend, duration)


class _Played:
    """A trajectory sampled once, however many loops follow it."""

    def __init__(self, table: Array, period: float) -> None:
        self._source = Direct(reference.COMPONENT, table=table, kernel=kernel(reference.COMPONENT))
        self._period = period
        self._samples: list[dict[str, float]] = []
        self.table = table

    def __getitem__(self, sample: int) -> dict[str, float]:
        while len(self._samples) <= sample:
            self._source.sample(self._period)
            self._samples.append(self._source.outputs())
        return self._samples[sample]


_PLAYED: dict[tuple[int, float], _Played] = {}


def played(table: Array, period: float) -> _Played:
    """The samples of the bus for a table."""
    key = (id(table), period)
    if key not in _PLAYED:
        _PLAYED[key] = _Played(table, period)
    return _PLAYED[key]


@dataclass(slots=True)
class Loop:
    """Reference, controller and car; `offset` [m] is the lateral error at the start."""

    table: Array
    offset: float = 0.0
    parameters: dict[str, float] = field(default_factory=dict)
    car: dict[str, float] = field(default_factory=dict)
    controller: Kernel | None = None
    bus: dict[str, float] = field(init=False, default_factory=dict)
    samples: int = field(init=False, default=0)
    mpc: Direct = field(init=False)
    plant: Direct = field(init=False)
    time: float = field(init=False, default=0.0)

    def __post_init__(self) -> None:
        row = self.table[0]
        start = {
            "initial.position.x": row[1] - self.offset * np.sin(row[3]),
            "initial.position.y": row[2] + self.offset * np.cos(row[3]),
            "initial.yaw": row[3],
            "initial.speed": row[4],
        }
        own = self.controller or kernel(mpc_allocator.COMPONENT)
        self.mpc = Direct(mpc_allocator.COMPONENT, self.parameters, kernel=own)
        self.plant = Direct(double_track.COMPONENT, start | self.car, kernel=kernel(double_track.COMPONENT))

    def step(self, hook: Hook = nothing) -> dict[str, float]:
        """One sample: reference, controller, car; the outputs of the controller and some of the car before it moved."""
        period = self.parameters.get("sample_period", PERIOD)
        self.bus = played(self.table, period)[self.samples]
        self.mpc.set(self.bus | estimate(self.plant) | {name: self.plant[name] for name in WHEEL_SPEEDS})
        hook(self.time, self.mpc, self.plant)
        self.mpc.sample(period)
        outputs = self.mpc.outputs()
        names = [*(f"wheel_torque.{wheel}" for wheel in WHEELS), "command.steer_angle"]
        self.plant.set({name: outputs[name] for name in names})
        car = {f"car.{name}": self.plant[name] for name in ("position.x", "position.y", "velocity.x")}
        seen = outputs | car | {"time": self.time}
        self.plant.advance(period)
        self.samples += 1
        self.time = self.samples * period
        return seen

    def run(self, duration: float, hook: Hook = nothing) -> dict[str, Array]:
        """What is seen, by name, over the samples of `duration` [s]."""
        period = self.parameters.get("sample_period", PERIOD)
        return recorded(lambda _: self.step(hook), round(duration / period))


def estimate(plant: Direct) -> dict[str, float]:
    """The true state of the car as the controller's estimate."""
    names = ("position.x", "position.y", "yaw", "velocity.x", "angular_rate.z", "velocity.y")
    return motion("estimate", *(plant[name] for name in names))


def lost(wheels: tuple[str, ...], since: float, *, told: bool = True) -> Hook:
    """The motors of `wheels` fail at `since` [s]; the controller is `told`, or finds it out."""

    def hook(t: float, mpc: Direct, plant: Direct) -> None:
        working = {f"motor_available.{wheel}": float(t < since) for wheel in wheels}
        plant.set(working)
        if told:
            mpc.set(working)

    return hook


def pushed(force: float) -> Hook:
    """A constant force [N] on the car to its left."""
    return lambda t, mpc, plant: plant.set({"body_force.y": force})


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
