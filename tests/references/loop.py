"""What closed loops in tests share: runs recorded by name, a controller run fast, and what a car tells of itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from fmukit.component import Component

Values = dict[str, float]


def recorded(step: Callable[[int], Mapping[str, Any]], samples: int) -> dict[str, np.ndarray]:
    """What step(k) gives for k = 0, 1, ..., as one array per name."""
    rows = [step(k) for k in range(samples)]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def rotation(yaw: float) -> np.ndarray:
    """Body to world in the plane."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])


def pose(whose: str, x: float, y: float, yaw: float) -> Values:
    """Position [m] and yaw angle [rad] as the inputs `whose`.* take them."""
    return {f"{whose}.position.x": x, f"{whose}.position.y": y, f"{whose}.yaw": yaw}


def motion(whose: str, x: float, y: float, yaw: float, v: float, w: float, slide: float = 0.0) -> Values:
    """The pose, the speeds ahead and to the left [m/s], and the yaw rate [rad/s]."""
    velocity = {f"{whose}.velocity.x": v, f"{whose}.velocity.y": slide}
    return pose(whose, x, y, yaw) | velocity | {f"{whose}.yaw_rate": w}


class Sampled:
    """The kernel of a sampled component and its state, called without copies: for loops of very many samples."""

    def __init__(self, component: Component, **parameters: float) -> None:
        """`parameters` by name with two underscores for a dot; unknown ones raise AssertionError."""
        interface, function = component.interface, component.kernel().step
        wanted = {v.name: float(v.start) for v in interface.select("parameter")}
        known = len(wanted)
        wanted |= {name.replace("__", "."): value for name, value in parameters.items()}
        assert len(wanted) == known, "unknown parameter"
        self.names, self.outputs = interface.names("input"), interface.names("output")
        self.start = {v.name: float(v.start) for v in interface.select("input")}
        self.p = np.array([wanted[name] for name in interface.names("parameter")])
        self.u, self.x, self.y = np.zeros(len(self.names)), np.zeros(function.numel_in(3)), np.zeros(len(self.outputs))
        self._later, none, clock = np.zeros_like(self.x), np.zeros(0), np.zeros(1)
        self._buffer, self._run = function.buffer()
        self._kept = (self.p, none, self.u, self.x, none, clock)
        for k, array in enumerate(self._kept):
            self._buffer.set_arg(k, memoryview(array))
        self._buffer.set_res(0, memoryview(self._later))
        self._buffer.set_res(1, memoryview(self.y))

    def step(self, inputs: Values) -> Values:
        """The outputs of a sample with these inputs, the others at their start; unknown ones raise AssertionError."""
        values = self.start | inputs
        assert len(values) == len(self.names), set(values) - set(self.names)
        self.u[:] = [values[name] for name in self.names]
        self._run()
        self.x[:] = self._later
        return dict(zip(self.outputs, self.y.tolist(), strict=True))
