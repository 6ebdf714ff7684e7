"""A system as data: named instances of models, and the rules that wire them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from cosim.errors import CosimError, unknown
from cosim.model.face import Value
from cosim.model.patterns import fitting, is_pattern


@dataclass
class Instance:
    """`model` is a catalogue name or a path to an .fmu; values still in text form are converted by the port's type.

    `patterns` are those of the parameters that were set by a pattern, which counts where the model has the variable.
    """

    model: str
    parameters: dict[str, Value] = field(default_factory=dict)
    period: float | None = None
    patterns: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Event:
    """`variable`, an unconnected input of `instance`, takes `value` at `time` [s].

    A `pattern` that it came from counts where the model has the variable.
    """

    time: float
    instance: str
    variable: str
    value: Value
    pattern: str = ""


@dataclass(frozen=True, slots=True)
class Wire:
    """Connect every input of `target` whose counterpart `source` has: see `System.connect`."""

    source: str
    target: str
    names: Mapping[str, str]

    def counterpart(self, input_: str) -> str | None:
        """The name of the output that feeds `input_`, by the exact name or the longest prefix that matches."""
        if input_ in self.names:
            return self.names[input_]
        prefixes = [prefix for prefix in self.names if input_.startswith(prefix) and prefix.endswith((".", "]"))]
        if prefixes:
            prefix = max(prefixes, key=len)
            return self.names[prefix] + input_[len(prefix) :]
        return self.names[""] + input_ if "" in self.names else None


@dataclass
class System:
    """Instances by name, in the order in which they are listed and recorded, wires between them, and events.

    Events are found by time, instance and variable.
    """

    instances: dict[str, Instance] = field(default_factory=dict)
    wires: list[Wire] = field(default_factory=list)
    events: dict[tuple[float, str, str], Event] = field(default_factory=dict)

    def add(
        self, name: str, model: str, parameters: Mapping[str, Value] | None = None, period: float | None = None
    ) -> None:
        """Add an instance; `period` [s] overrides the model's default step."""
        if name in self.instances:
            raise CosimError(f"the system has two instances named {name}")
        self.instances[name] = Instance(model, dict(parameters or {}), period)

    def connect(self, source: str, target: str, names: Mapping[str, str] | None = None) -> None:
        """Wire `source` to `target`, same name to same name, or as `names` maps inputs to outputs.

        A key of `names` is the full name of an input, or a prefix ending in a dot ("" is every input); the value takes
        its place: {"estimate.": ""} feeds estimate.yaw from yaw, {"estimate.yaw_rate": "angular_rate.z"} one port.
        """
        for name in (source, target):
            if name not in self.instances:
                raise unknown("instance", name, self.instances)
        self.wires.append(Wire(source, target, dict(names if names is not None else {"": ""})))

    def set(self, assignment: str, value: Value) -> None:
        """Set `instance.variable` (instance names may contain dots) to a value, possibly still in text form.

        Where no instance has that name, * and ? in it stand for characters between two dots, and all that fit and have
        the variable are set.
        """
        for name, variable, pattern in self.selected(assignment):
            instance = self.instances[name]
            if not pattern:
                instance.patterns.pop(variable, None)
            elif variable not in instance.parameters:
                instance.patterns[variable] = pattern
            instance.parameters[variable] = value

    def at(self, time: float, signal: str, value: Value) -> None:
        """From `time` [s] on the unconnected input `instance.variable` holds `value`, until an event sets it again.

        It takes effect when the instance next takes its inputs, at that time or after it. Of two events for one input
        at one time the later call counts. Patterns are those of `set`.
        """
        if not (math.isfinite(time) and time >= 0.0):
            raise CosimError(f"{signal} cannot be set at {time:g} s; give a time that is finite and not negative")
        for instance, variable, pattern in self.selected(signal):
            self.events[time, instance, variable] = Event(time, instance, variable, value, pattern)

    def selected(self, signal: str) -> list[tuple[str, str, str]]:
        """(instance, variable, pattern) of all that `signal` means; the pattern is "" where it is a name."""
        if is_pattern(signal) and not self._named(signal):
            return [(*found, signal) for found in fitting(signal, self.instances)]
        return [(*self.split(signal), "")]

    def split(self, signal: str) -> tuple[str, str]:
        """(instance, variable) of `instance.variable`, with the longest instance name that fits."""
        fitting = self._named(signal)
        if not fitting:
            dots = max((name.count(".") for name in self.instances), default=0)
            raise unknown("instance", ".".join(signal.split(".")[:-1][: dots + 1]), self.instances)
        instance = max(fitting, key=len)
        return instance, signal[len(instance) + 1 :]

    def _named(self, signal: str) -> list[str]:
        return [name for name in self.instances if signal.startswith(name + ".")]


def parse_assignments(texts: Iterable[str]) -> list[tuple[str, str]]:
    """[("llc.suspension.enabled", "false")] from ["llc.suspension.enabled=false"]."""
    pairs = []
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or "." not in name.strip():
            raise CosimError(f"cannot read {text!r}; write --set instance.variable=value")
        pairs.append((name.strip(), value.strip()))
    return pairs


def parse_events(texts: Iterable[str]) -> list[tuple[float, str, str]]:
    """[(3.0, "mpc.motor_available.rr", "0")] from ["3.0:mpc.motor_available.rr=0"]."""
    events = []
    for text in texts:
        time, colon, assignment = text.partition(":")
        name, equals, value = assignment.partition("=")
        try:
            seconds = float(time)
        except ValueError:
            colon = ""
        if not (colon and equals) or "." not in name.strip():
            raise CosimError(f"cannot read {text!r}; write --at time:instance.variable=value with the time in seconds")
        events.append((seconds, name.strip(), value.strip()))
    return events
