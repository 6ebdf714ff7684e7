"""A system as data: named instances of models, the rules that wire them, and what is set of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cosim.errors import CosimError, unknown
from cosim.model.clock import LONGEST
from cosim.model.face import Kind, Value
from cosim.model.fault import Fault
from cosim.model.patterns import is_pattern, matches
from cosim.model.transformation import Transformation


@dataclass
class Instance:
    """One instance of `model`, the name of a model that is offered or a path to an .fmu file.

    `parameters` are the values its system gives it, by the name of the variable; values in text form are converted
    to the type of the variable. `period` [s] is its communication period; None leaves it to the model.
    `kind` says how it is run, for a model whose description does not tell: a plant ("continuous") or a controller
    ("sampled"); None goes by the variability of its outputs. `isolated`: it runs in a process of its own.
    """

    model: str
    parameters: dict[str, Value] = field(default_factory=dict)
    period: float | None = None
    kind: Kind | None = None
    isolated: bool = False


@dataclass(frozen=True, slots=True)
class Assignment:
    """`signal`, an `instance.variable` or a pattern of such names, has `value` before the start."""

    signal: str
    value: Value


@dataclass(frozen=True, slots=True)
class Event:
    """The unconnected input `signal`, an `instance.variable` or a pattern of such, takes `value` at `time` [s]."""

    time: float
    signal: str
    value: Value


@dataclass(frozen=True, slots=True)
class Wire:
    """Connect every input of `target` whose counterpart `source` has: see `System.connect`.

    A `lenient` one does without those that there are not.
    """

    source: str
    target: str
    names: Mapping[str, str]
    lenient: bool = False

    def counterpart(self, input_: str) -> str | None:
        """The name of the output that feeds `input_`, by the exact name or the longest prefix that matches."""
        if input_ in self.names:
            return self.names[input_]
        prefixes = [prefix for prefix in self.names if input_.startswith(prefix) and prefix.endswith((".", "]"))]
        if prefixes:
            prefix = max(prefixes, key=len)
            return self.names[prefix] + input_[len(prefix) :]
        return self.names[""] + input_ if "" in self.names else None


@dataclass(frozen=True, slots=True)
class Link:
    """One output, `source`.`output`, feeds one input, `target`.`input`.

    `transformation` is what becomes of the value; None converts between the units of the two.
    """

    source: str
    output: str
    target: str
    input: str
    transformation: Transformation | None = None


@dataclass
class System:
    """Instances by name, in the order in which they are listed and recorded, and the wires and links between them.

    `assignments` are values set of instances beyond their own parameters, in the order in which they were made; the
    last one counts. `events` are values set during the run; `faults` change what inputs take while they last. `files`
    are the .fmu files of models that the system brings along, by the names its instances give.
    """

    instances: dict[str, Instance] = field(default_factory=dict)
    wires: list[Wire] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    assignments: list[Assignment] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    files: dict[str, Path] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)

    def add(
        self,
        name: str,
        model: str,
        parameters: Mapping[str, Value] | None = None,
        period: float | None = None,
        kind: Kind | None = None,
        *,
        isolated: bool = False,
    ) -> None:
        """Add an instance; `period` [s] overrides the model's default step, `kind` how it is run.

        What goes wrong in an `isolated` one cannot take the run down: it has a process of its own.
        """
        if name in self.instances:
            raise CosimError(f"the system has two instances named {name}")
        self.instances[name] = Instance(model, dict(parameters or {}), period, kind, isolated)

    def isolate(self, pattern: str) -> None:
        """Give instances processes of their own: those whose name, or a beginning of it up to a dot, fits the pattern.

        "all" are all; `car*` are car1, car1.plant and car2.plant. Raises CosimError when none is meant.
        """
        meant = [name for name in self.instances if pattern == "all" or _is_meant(name, pattern)]
        if not meant:
            raise unknown("instance", pattern, self.instances, "`--explain` lists the instances")
        for name in meant:
            self.instances[name].isolated = True

    def pace(self, pattern: str, period: float) -> None:
        """Give the instances whose names fit the pattern another period [s]; raises CosimError when there is none."""
        meant = [name for name in self.instances if matches(name, pattern)]
        if not meant:
            raise unknown("instance", pattern, self.instances, "`--explain` lists the instances")
        for name in meant:
            self.instances[name].period = period

    def connect(
        self, source: str, target: str, names: Mapping[str, str] | None = None, *, lenient: bool = False
    ) -> None:
        """Wire `source` to `target`, same name to same name, or as `names` maps inputs to outputs.

        A key of `names` is the full name of an input, or a prefix ending in a dot ("" is every input); the value takes
        its place: {"estimate.": ""} feeds estimate.yaw from yaw, {"estimate.yaw_rate": "angular_rate.z"} one port.
        A `lenient` wire leaves out names there are not.
        """
        self._expect(source, target)
        self.wires.append(Wire(source, target, dict(names if names is not None else {"": ""}), lenient))

    def link(
        self, source: tuple[str, str], target: tuple[str, str], transformation: Transformation | None = None
    ) -> None:
        """Feed one input from one output, each an (instance, variable); `transformation` instead of that by units."""
        self._expect(source[0], target[0])
        self.links.append(Link(*source, *target, transformation))

    def set(self, signal: str, value: Value) -> None:
        """Set `instance.variable` (instance names may contain dots) to a value, possibly still in text form.

        `signal` may be a pattern (see `cosim.model.patterns`): all variables whose names fit it are set.
        """
        self._expect_instance(signal)
        self.assignments.append(Assignment(signal, value))

    def at(self, time: float, signal: str, value: Value) -> None:
        """From `time` [s] on the unconnected input `instance.variable` holds `value`, until an event sets it again.

        It takes effect when the instance next takes its inputs, at that time or after it. Of two events for one input
        at one time the later call counts. `signal` may be a pattern.
        """
        if not 0.0 <= time <= LONGEST:
            raise CosimError(f"{signal} cannot be set at {time:g} s; give a time from 0 to {LONGEST:g} s")
        self._expect_instance(signal)
        self.events.append(Event(time, signal, value))

    def fail(self, fault: Fault) -> None:
        """Let an input have a fault; of several on one input each acts on what the one before gives."""
        self._expect_instance(fault.signal)
        self.faults.append(fault)

    def is_name(self, signal: str) -> bool:
        """Whether `signal` names a variable of one instance, though it may hold characters of patterns."""
        return not is_pattern(signal) or bool(self._named(signal))

    def split(self, signal: str) -> tuple[str, str]:
        """(instance, variable) of `instance.variable`, with the longest instance name that fits."""
        fitting = self._named(signal)
        if not fitting:
            dots = max((name.count(".") for name in self.instances), default=0)
            raise unknown("instance", ".".join(signal.split(".")[:-1][: dots + 1]), self.instances)
        instance = max(fitting, key=len)
        return instance, signal[len(instance) + 1 :]

    def _expect(self, *names: str) -> None:
        for name in names:
            if name not in self.instances:
                raise unknown("instance", name, self.instances)

    def _expect_instance(self, signal: str) -> None:
        if self.is_name(signal):
            self.split(signal)

    def _named(self, signal: str) -> list[str]:
        return [name for name in self.instances if signal.startswith(name + ".")]


def _is_meant(name: str, pattern: str) -> bool:
    parts = name.split(".")
    return any(matches(".".join(parts[: k + 1]), pattern) for k in range(len(parts)))
