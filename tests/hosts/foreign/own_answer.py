"""A system as a job for foreign hosts, and what our own master makes of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
from host_job import Job
from numpy.typing import NDArray

from cosim.engine.loader import Loader
from cosim.engine.master import Master
from cosim.engine.models import find
from cosim.engine.schedule import schedule
from cosim.model.assembly import assemble, leave_out
from cosim.model.configuration import Configuration
from cosim.model.face import Value
from cosim.model.node import Node
from cosim.model.system import System
from cosim.results.recorder import recorded
from cosim.run.prepare import configured
from cosim.run.request import FAULT, Request
from cosim.scenario.discovery import load

Answer = NDArray[np.float64]
Make = Callable[[Loader], Configuration]
"""What gives the values of a system, once the faces of its models can be loaded."""


def of_scenario(name: str, *assignments: tuple[str, str]) -> Make:
    """The system of a scenario, completed."""
    return lambda loader: configured(Request(load(name), Path(), assignments), loader).configuration


def alone(model: str, values: Mapping[str, Value]) -> Make:
    """One instance of a model."""
    system = System()
    system.add("alone", model, values)
    return lambda loader: Configuration(system, loader.faces(system))


def ask(make: Make, step: float, steps: int, every: int) -> tuple[Job, Answer]:
    """The job, and our answer to it."""
    with Loader(find) as loader:
        nodes = assemble(make(loader), 0, step)
        leave_out(nodes, [FAULT])
        master = Master(nodes, schedule(nodes, "jacobi"), loader.slaves(nodes))
        chosen = recorded(master.signals)
        signals = [(master.signals[i].instance, master.signals[i].variable) for i in chosen]
        master.initialise()
        rows: list[Answer] = []
        places = [1 + i for i in chosen]
        outcome = master.run(round(step * 1e9) * steps, lambda: rows.append(master.vector[places]))
    assert outcome.status == "ok", outcome.reason
    job: Job = {"step": step, "steps": steps, "every": every, "connections": _connections(nodes)}
    job["instances"] = {name: _instance(node, find(node.model)) for name, node in nodes.items()}
    job["signals"] = [(name, port, nodes[name].face.ports[port].reference) for name, port in signals]
    return job, np.array(rows[every::every])


def _instance(node: Node, file: Path) -> dict[str, object]:
    ports = node.face.ports
    values = {name: (ports[name].type, value, ports[name].reference) for name, value in node.values.items()}
    return {"fmu": str(file), "values": values}


def _connections(nodes: Mapping[str, Node]) -> list[list[object]]:
    found = []
    for node in nodes.values():
        for c in node.incoming.values():
            assert not c.transformation.steps, f"{c.text}: these hosts are not told to convert units"
            output, input_ = nodes[c.source].face.ports[c.output], node.face.ports[c.input]
            found.append([c.source, c.output, output.reference, c.target, c.input, input_.reference])
    return found
