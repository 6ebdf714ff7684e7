"""What can happen to a signal: each effect makes, when it begins, something that gives the value of each exchange.

What is made is called with the time [s] and the value that would have been taken, at every exchange while the effect
lasts. It keeps all it needs to go on, so that a run can be continued from a copy of it.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Protocol

import numpy as np

Acting = Callable[[float, float], float]
ROUNDING = 1e-10
"""Two times [s] nearer than that are one."""


class Effect(Protocol):
    """One kind of effect with its numbers."""

    def begin(self, time: float, value: float, random: np.random.Generator) -> Acting:
        """Begins at `time` [s], where the signal has `value`."""

    @property
    def values(self) -> tuple[float, ...]:
        """The values that the signal is given, whatever it has; none where they depend on it."""


@dataclass(frozen=True, slots=True)
class Override:
    """The signal has `value`."""

    value: float

    @property
    def values(self) -> tuple[float, ...]:
        return (self.value,)

    def begin(self, _time: float, _value: float, _random: np.random.Generator) -> Acting:
        return _Line((0.0,), (self.value,))


@dataclass(frozen=True, slots=True)
class Ramp:
    """From what it has to `value` within `duration` [s], and there it stays."""

    value: float
    duration: float

    @property
    def values(self) -> tuple[float, ...]:
        return (self.value,)

    def begin(self, time: float, value: float, _random: np.random.Generator) -> Acting:
        return _Line((time, time + self.duration), (value, self.value))


@dataclass(frozen=True, slots=True)
class Table:
    """The signal follows a table of `times` [s] and values, on straight lines; first and last value are held."""

    times: tuple[float, ...]
    values: tuple[float, ...]

    def begin(self, _time: float, _value: float, _random: np.random.Generator) -> Acting:
        return _Line(self.times, self.values)


@dataclass(frozen=True, slots=True)
class Linear:
    """factor * value + bias."""

    factor: float = 1.0
    bias: float = 0.0
    values: tuple[float, ...] = ()

    def begin(self, _time: float, _value: float, _random: np.random.Generator) -> Acting:
        return _Scaled(self.factor, self.bias)


@dataclass(frozen=True, slots=True)
class Noise:
    """Normally distributed noise of standard deviation `sigma`, independent from exchange to exchange."""

    sigma: float
    values: tuple[float, ...] = ()

    def begin(self, _time: float, _value: float, random: np.random.Generator) -> Acting:
        return _Noisy(self.sigma, random)


@dataclass(frozen=True, slots=True)
class Freeze:
    """The value at the beginning stays."""

    values: tuple[float, ...] = ()

    def begin(self, _time: float, value: float, _random: np.random.Generator) -> Acting:
        return _Line((0.0,), (value,))


@dataclass(frozen=True, slots=True)
class Delay:
    """Values arrive `duration` [s] later; until the first of them has arrived the one at the beginning stays."""

    duration: float
    values: tuple[float, ...] = ()

    def begin(self, _time: float, value: float, _random: np.random.Generator) -> Acting:
        return _Delayed(self.duration, value)


@dataclass(frozen=True, slots=True)
class Drop:
    """Each new value is lost with this probability: the one before it stays.

    A value that is offered again, as by a receiver between two of its messages, is not new.
    """

    probability: float
    values: tuple[float, ...] = ()

    def begin(self, _time: float, value: float, random: np.random.Generator) -> Acting:
        return _Dropping(self.probability, random, value, value)


@dataclass(slots=True)
class _Line:
    times: Any
    heights: Any

    def __post_init__(self) -> None:
        self.times, self.heights = np.asarray(self.times, float), np.asarray(self.heights, float)

    def __call__(self, time: float, _value: float) -> float:
        return float(np.interp(time, self.times, self.heights))


@dataclass(slots=True)
class _Scaled:
    factor: float
    bias: float

    def __call__(self, _time: float, value: float) -> float:
        return self.factor * value + self.bias


@dataclass(slots=True)
class _Noisy:
    sigma: float
    random: np.random.Generator

    def __call__(self, _time: float, value: float) -> float:
        return value + self.sigma * float(self.random.standard_normal())


@dataclass(slots=True)
class _Delayed:
    duration: float
    last: float
    way: deque[tuple[float, float]] = field(default_factory=deque)

    def __call__(self, time: float, value: float) -> float:
        self.way.append((time, value))
        while self.way and self.way[0][0] <= time - self.duration + ROUNDING:
            self.last = self.way.popleft()[1]
        return self.last


@dataclass(slots=True)
class _Dropping:
    probability: float
    random: np.random.Generator
    last: float
    offered: float

    def __call__(self, _time: float, value: float) -> float:
        if value != self.offered:
            self.offered = value
            if self.random.random() >= self.probability:
                self.last = value
        return self.last


_KINDS = {kind.__name__: kind for kind in (_Line, _Scaled, _Noisy, _Delayed, _Dropping)}


def state_of(act: Acting) -> dict[str, Any]:
    """What has begun, in plain values; the source of random numbers is left out."""
    values = {each.name: getattr(act, each.name) for each in fields(act) if each.name != "random"}  # type: ignore[arg-type]
    return {"kind": type(act).__name__} | {key: _listed(value) for key, value in values.items()}


def _listed(value: Any) -> Any:
    return list(value) if isinstance(value, deque) else value.tolist() if isinstance(value, np.ndarray) else value


def acting_of(state: Mapping[str, Any], random: np.random.Generator) -> Acting:
    """What had begun when `state_of` was asked."""
    kind = _KINDS[state["kind"]]
    own = {key: value for key, value in state.items() if key != "kind"}
    if "way" in own:
        own["way"] = deque((time, value) for time, value in own["way"])
    if any(each.name == "random" for each in fields(kind)):
        own["random"] = random
    made: Acting = kind(**own)
    return made
