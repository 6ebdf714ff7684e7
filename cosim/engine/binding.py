"""A slave is bound to its memory: parts of the signal vector, or copies that are shown when a step ends."""

from __future__ import annotations

from collections.abc import Mapping
from ctypes import c_double
from functools import partial
from typing import NamedTuple

import numpy as np

from cosim.engine.bound import Bound, gather, gather_texts
from cosim.engine.order import Action, both
from cosim.engine.slave import Memory, Slave, do_nothing
from cosim.model.clock import to_seconds
from cosim.model.node import Node
from cosim.model.signals import Vector


class Shown(NamedTuple):
    """What all instances share: the `time` [s], signals in `vector` and `texts`, and at which places they are there."""

    time: c_double
    vector: Vector
    places: Mapping[str, int]
    texts: list[str]
    words: Mapping[str, int]


def bind(node: Node, slave: Slave, shown: Shown, parallel: bool) -> Bound:
    """The slave with its calls; the outputs of a `parallel` one belong to the end of its step."""
    outputs = node.outputs
    first = shown.places[f"{node.name}.{outputs[0]}"] if outputs else 0
    numbers, texts = node.incoming_numbers, node.incoming_texts
    u, step = np.zeros(len(numbers)), c_double(to_seconds(node.period))
    place = shown.vector[first : first + len(outputs)]
    w, z = [""] * len(texts), [""] * len(node.texts)
    y, publish = place, _writing(node, z, shown)
    if parallel:
        y = place.copy()
        publish = both(partial(np.copyto, place, y), publish)
    names, written = ([c.input for c in some] for some in (numbers, texts))
    memory = Memory(shown.time, step, names, u, outputs, y, node.texts, z, written, w)
    gathered = both(gather(numbers, shown.vector, shown.places, u), gather_texts(texts, shown.texts, shown.words, w))
    return Bound(node, slave, slave.bind(memory), gathered, publish, memory)


def _writing(node: Node, own: list[str], shown: Shown) -> Action:
    """Shows the texts of a node to the others and to the recorder."""
    if not own:
        return do_nothing
    first = shown.words[f"{node.name}.{node.texts[0]}"]
    return partial(shown.texts.__setitem__, slice(first, first + len(own)), own)
