"""One slave bound to its memory: what the master does with it at a tick, timed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from time import perf_counter_ns

import numpy as np

from cosim.engine.order import Action
from cosim.engine.slave import DISCARD, ERROR, WARNING, Calls, Memory, Slave, SlaveError, do_nothing
from cosim.model.node import Connection, Node
from cosim.model.signals import Vector
from cosim.model.units import Conversion


class Bound:
    """A slave, its calls, and the copy that gathers its inputs; counts steps and time [ns] spent in the slave.

    `publish` shows the outputs got last to all others, of a slave that does not write them straight into their vector.
    `memory` is what its calls work on.
    """

    __slots__ = ("calls", "count", "gather", "held", "node", "publish", "said", "slave", "step", "time")

    def __init__(self, node: Node, slave: Slave, calls: Calls, gather: Action, publish: Action, memory: Memory) -> None:
        self.node, self.slave, self.calls, self.step = node, slave, calls, memory.step
        self.held, self.said = memory.y, memory.z
        self.gather, self.publish = gather, publish
        self.count = self.time = 0

    def check(self, status: int) -> None:
        """Raise SlaveError with the slave's own words for an fmi2Status above warning."""
        if status > WARNING:
            self.slave.failed(status)
            ended = status == DISCARD and self.slave.ended()
            raise SlaveError(self.node.name, status, self.slave.message(), ended=ended)

    def exchange(self) -> None:
        """Gather, set, step, get; the three calls are timed."""
        self.gather()
        set_, step, get = self.calls
        start = perf_counter_ns()
        status = set_()
        if status <= WARNING:
            status = step()
            if status <= WARNING:
                status = get()
        self.time += perf_counter_ns() - start
        self.count += 1
        if status > WARNING:
            self.check(status)


def gather(connections: Sequence[Connection], vector: Vector, positions: Mapping[str, int], u: Vector) -> Action:
    """One indexed copy of the connected inputs that are numbers, transformed where a connection says so."""
    if not connections:
        return do_nothing
    index = np.array([positions[f"{c.source}.{c.output}"] for c in connections])
    take = partial(vector.take, index, None, u, "clip")  # "clip" writes straight into u, "raise" copies twice
    if not any(c.transformation.steps for c in connections):
        return take
    steps = [c.transformation.linear or Conversion() for c in connections]
    factor, offset = (np.array([getattr(step, key) for step in steps]) for key in ("factor", "offset"))
    by_list = [(k, c) for k, c in enumerate(connections) if c.transformation.linear is None]

    def transformed() -> None:
        take()
        np.multiply(u, factor, out=u)
        np.add(u, offset, out=u)
        for k, connection in by_list:
            u[k] = looked_up(connection, u[k])

    return transformed


def gather_texts(
    connections: Sequence[Connection], texts: Sequence[str], positions: Mapping[str, int], w: list[str]
) -> Action:
    """A copy of the connected inputs that are Strings."""
    places = [positions[f"{c.source}.{c.output}"] for c in connections]

    def copy() -> None:
        w[:] = [texts[place] for place in places]

    return copy if places else do_nothing


def looked_up(connection: Connection, value: float) -> float:
    """What becomes of the value on its way; raises SlaveError of the one it goes to where nothing says."""
    try:
        return connection.transformation(value)
    except LookupError:
        message = f"{connection.text} has no entry for the value {value:g}"
        raise SlaveError(connection.target, ERROR, message) from None
