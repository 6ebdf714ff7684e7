"""One instance of a system, checked, and what feeds it."""

from __future__ import annotations

from dataclasses import dataclass, field

from cosim.model.face import TYPES, Face, Kind, Value
from cosim.model.fault import Fault
from cosim.model.signals import Signal
from cosim.model.transformation import AS_IT_IS, Transformation


@dataclass(frozen=True, slots=True)
class Connection:
    """One output to one input; `transformation` is what becomes of the value on its way."""

    source: str
    output: str
    target: str
    input: str
    transformation: Transformation = AS_IT_IS

    @property
    def text(self) -> str:
        return f"{self.source}.{self.output} -> {self.target}.{self.input}"


@dataclass(frozen=True, slots=True)
class Change:
    """The input `variable` takes `value` at `time` [ns]; the instance takes it in at `due` [ns].

    `signal` is how it was named: a name, or a pattern.
    """

    time: int
    due: int
    variable: str
    value: Value
    signal: str


@dataclass(slots=True)
class Node:
    """One instance of `model`, checked. `period` [ns]; `values` are set before initialisation; `incoming` by input.

    `changes` of unconnected inputs during the run, in order of time. `outputs` are those that are fetched, all numbers
    as doubles; `texts` are the Strings. An `isolated` one runs in a process of its own.
    `faults` are those of its inputs, by input, and `seed` is the run's. `given` are parameters that others calculate
    while all initialise, by parameter.
    """

    name: str
    model: str
    face: Face
    period: int
    kind: Kind
    values: dict[str, Value]
    incoming: dict[str, Connection] = field(default_factory=dict)
    changes: list[Change] = field(default_factory=list)
    outputs: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    isolated: bool = False
    faults: dict[str, list[Fault]] = field(default_factory=dict)
    seed: int = 0
    given: dict[str, Connection] = field(default_factory=dict)

    @property
    def connections(self) -> list[Connection]:
        """All that feeds the node, at every exchange or once."""
        return [*self.incoming.values(), *self.given.values()]

    @property
    def incoming_numbers(self) -> list[Connection]:
        """Where the inputs that are numbers come from, type by type; those with faults from a signal of their own."""
        own = {name: Connection(self.name, name, self.name, name) for name in self.faults}
        found = {name: c for name, c in (self.incoming | own).items() if self.face.ports[name].type != "String"}
        return [c for _, c in sorted(found.items(), key=lambda item: place(self.face, item[0]))]

    @property
    def incoming_texts(self) -> list[Connection]:
        """Connections of String inputs."""
        return [c for name, c in self.incoming.items() if self.face.ports[name].type == "String"]

    def signal(self, name: str) -> Signal:
        """What the variable `name` is in the signal vector."""
        port = self.face.ports[name]
        return Signal(self.name, name, port.unit, port.type)

    def __post_init__(self) -> None:
        self.outputs, self.texts = self.face.numbers, self.face.texts

    def show(self, variable: str) -> None:
        """Fetch a variable that is no output among the outputs."""
        if self.face.ports[variable].type == "String":
            self.texts = tuple(dict.fromkeys((*self.texts, variable)))
        else:
            found = dict.fromkeys((*self.outputs, variable))
            self.outputs = tuple(sorted(found, key=lambda name: place(self.face, name)))


def place(face: Face, input_: str) -> int:
    """Variables are taken and given type by type, in the order of `TYPES`."""
    return TYPES.index(face.ports[input_].type)
