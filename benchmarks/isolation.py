"""What a process of its own costs an instance: set, step and get through it, beside the same calls in-process.

Both slaves are those of the master, bound as it binds them, and are called alternately in one run.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from ctypes import c_double
from statistics import median

import numpy as np

from cosim.engine.loader import Loader
from cosim.engine.models import find
from cosim.engine.slave import Memory, Slave
from cosim.model.assembly import assemble
from cosim.model.clock import to_seconds
from cosim.model.configuration import Configuration
from cosim.model.system import System

ROUNDS = 25
_CALLS = 400
_MODELS = ("Vehicle16Dof", "Imu")


def rows(rounds: int | None) -> Iterator[tuple[str, str, str, str]]:
    """The rows of the table of `python -m benchmarks`."""
    for model in _MODELS:
        seen = measure(model, rounds or ROUNDS)
        against = f"{seen['isolated']:.1f} us / {seen['inside']:.1f} us in the process of the master"
        yield f"{model} isolated: set + step + get", f"{seen['ratio']:.2f}", against, ""


def measure(model: str, rounds: int = ROUNDS) -> dict[str, float]:
    """Median microseconds per exchange of `model` `inside` and `isolated`; `ratio` of neighbouring rounds."""
    system = System()
    system.add("inside", model)
    system.add("isolated", model, isolated=True)
    with Loader(find) as loader:
        nodes = assemble(Configuration(system, loader.faces(system)), 0)
        exchanges = {
            name: _exchange(slave, to_seconds(nodes[name].period)) for name, slave in loader.slaves(nodes).items()
        }
        pairs = [tuple(_time(exchanges[name]) for name in ("isolated", "inside")) for _ in range(rounds + 2)][2:]
    isolated, inside = zip(*pairs, strict=True)
    return {
        "isolated": median(isolated),
        "inside": median(inside),
        "ratio": median(one / other for one, other in pairs),
    }


def _exchange(slave: Slave, step: float) -> Callable[[], None]:
    """Initialise the slave; the returned function makes exchanges at the start values."""
    face = slave.face
    u = np.array([float(face.ports[name].start or 0.0) for name in face.inputs])
    now, outputs = c_double(0.0), face.outputs
    slave.enter()
    set_, do_step, get = slave.bind(Memory(now, c_double(step), face.inputs, u, outputs, np.zeros(len(outputs))))
    slave.leave()

    def exchange() -> None:
        for _ in range(_CALLS):
            if set_() or do_step() or get():
                raise RuntimeError(f"{face.model} failed at {now.value} s: {slave.message()}")
            now.value += step

    return exchange


def _time(exchange: Callable[[], None]) -> float:
    start = time.perf_counter()
    exchange()
    return (time.perf_counter() - start) / _CALLS * 1e6
