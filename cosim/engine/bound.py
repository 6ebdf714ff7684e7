"""One slave bound to its memory: what the master does with it at a tick, timed."""

from __future__ import annotations

from collections.abc import Mapping
from ctypes import c_double
from functools import partial
from time import perf_counter_ns

import numpy as np

from cosim.engine.order import Action
from cosim.engine.slave import DISCARD, WARNING, Calls, Slave, SlaveError, do_nothing
from cosim.model.assembly import Node
from cosim.model.signals import Vector


class Bound:
    """A slave, its calls, and the copy that gathers its inputs; counts steps and time [ns] spent in the slave.

    `publish` shows the outputs got last to all others, of a slave that does not write them straight into their vector.
    """

    __slots__ = ("calls", "count", "gather", "node", "publish", "slave", "step", "time")

    def __init__(self, node: Node, slave: Slave, calls: Calls, gather: Action, publish: Action, step: c_double) -> None:
        self.node, self.slave, self.calls, self.step = node, slave, calls, step
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


def gather(node: Node, vector: Vector, positions: Mapping[str, int], u: Vector) -> Action:
    """One indexed copy of the connected inputs, converted where units differ."""
    if not node.incoming:
        return do_nothing
    connections = node.incoming.values()
    index = np.array([positions[f"{c.source}.{c.output}"] for c in connections])
    take = partial(vector.take, index, None, u, "clip")  # "clip" writes straight into u, "raise" copies twice
    if all(c.conversion.trivial for c in connections):
        return take
    factor, offset = (np.array([getattr(c.conversion, key) for c in connections]) for key in ("factor", "offset"))

    def converted() -> None:
        take()
        np.multiply(u, factor, out=u)
        np.add(u, offset, out=u)

    return converted
