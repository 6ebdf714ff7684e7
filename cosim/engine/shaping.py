"""Faults at work: before an instance takes its inputs, those that have faults are worked out and shown.

Such an input is a signal of its own in the vector; what it would have been is the output that feeds it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cosim.engine.bound import looked_up
from cosim.engine.changes import start
from cosim.model.assembly import derived_seed
from cosim.model.effects import ROUNDING, Acting, acting_of, state_of
from cosim.model.fault import Fault
from cosim.model.node import Node
from cosim.model.signals import Vector
from cosim.model.values import INTEGERS


@dataclass(slots=True)
class Shaper:
    """One input of the FMI type `kind`: `place` is its own in the vector, `base` gives what it would be.

    Faults act in their order; what they draw at random follows from the `seed`. What is shown is what an FMU can take.
    """

    vector: Vector
    place: int
    base: Callable[[], float]
    faults: Sequence[Fault]
    positions: Mapping[str, int]
    seed: int
    kind: str = "Real"
    random: np.random.Generator = field(init=False)
    acting: list[Acting | None] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.begin_anew()

    def begin_anew(self) -> None:
        """Forget all that has begun."""
        self.random = np.random.default_rng(self.seed)
        self.acting = [None] * len(self.faults)

    def __call__(self) -> None:
        """Show the value of now."""
        time, value = float(self.vector[0]), self.base()
        for k, fault in enumerate(self.faults):
            if not self._lasts(fault, time):
                self.acting[k] = None
                continue
            act = self.acting[k] or fault.effect.begin(time, value, self.random)
            self.acting[k] = act
            value = act(time, value)
        self.vector[self.place] = _fitting(value, self.kind)

    def state(self) -> dict[str, Any]:
        """What lasts, in plain values."""
        acting = [None if act is None else state_of(act) for act in self.acting]
        return {"acting": acting, "random": self.random.bit_generator.state}

    def put_back(self, state: Mapping[str, Any]) -> None:
        """Be as at `state`."""
        self.random.bit_generator.state = state["random"]
        self.acting[:] = [None if each is None else acting_of(each, self.random) for each in state["acting"]]

    def _lasts(self, fault: Fault, time: float) -> bool:
        inside = fault.begin - ROUNDING <= time < fault.end - ROUNDING
        return inside and all(each.holds(self.vector[self.positions[each.signal]]) for each in fault.when)


def shapers(node: Node, vector: Vector, positions: Mapping[str, int]) -> list[Shaper]:
    """One for each input of the node that has faults; noise is seeded by the run's seed and the signal's name."""
    return [
        Shaper(
            vector,
            positions[f"{node.name}.{name}"],
            _base(node, name, vector, positions),
            faults,
            positions,
            derived_seed(node.seed, f"{node.name}.{name}"),
            node.face.ports[name].type,
        )
        for name, faults in node.faults.items()
    ]


def _fitting(value: float, kind: str) -> float:
    """Of whole numbers the nearest that there is."""
    return value if kind == "Real" else float(min(max(round(value), INTEGERS[0]), INTEGERS[1]))


def _base(node: Node, name: str, vector: Vector, positions: Mapping[str, int]) -> Callable[[], float]:
    """What the input would be: what feeds it, or what it started with."""
    connection = node.incoming.get(name)
    if connection is None:
        started = start(node, name)
        return lambda: started
    place = positions[f"{connection.source}.{connection.output}"]
    return lambda: looked_up(connection, float(vector[place]))
