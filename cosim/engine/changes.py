"""Events at their ticks: inputs nothing feeds are set, and shown in the signal vector."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial

from cosim.engine.order import Action, Order, Tick
from cosim.engine.slave import do_nothing
from cosim.model.face import Value
from cosim.model.node import Node
from cosim.model.signals import Vector


@dataclass(frozen=True, slots=True)
class Due:
    """One change at the tick `time` [ns]: `set` hands it to the slave, `show` writes it into the signal vector.

    `early`: the slave takes its inputs before the row is recorded, else after it.
    """

    time: int
    early: bool
    set: Action
    show: Action


def merged(ticks: Iterable[Tick], dues: Iterable[Due]) -> Iterator[Tick]:
    """The ticks with the changes: all are in the row of their tick, and set just before their slave's other inputs."""
    at: dict[int, list[Due]] = {}
    for due in dues:
        at.setdefault(due.time, []).append(due)
    for time, order in ticks:
        yield time, _with(at[time], order) if time in at else order


def shown(node: Node) -> list[str]:
    """Inputs that events change and that are numbers, each once."""
    names = dict.fromkeys([*(change.variable for change in node.changes), *node.faults])
    return [name for name in names if node.face.ports[name].type != "String"]


def start(node: Node, name: str) -> float:
    """What an input holds before its first event."""
    value = node.values.get(name, node.face.ports[name].start)
    return 0.0 if value is None else float(value)


def writer(vector: Vector, place: int | None, value: Value) -> Action:
    """Writes a number to its place in the vector; a text has none."""
    return do_nothing if place is None else partial(vector.__setitem__, place, float(value))


def _with(dues: list[Due], order: Order) -> Order:
    """Events at a slave that runs before the row come first of all, those at one that steps after it follow the row."""
    early, late = ([due.set for due in dues if due.early is first] for first in (True, False))
    return order.framed([*(due.show for due in dues), *early], late)
