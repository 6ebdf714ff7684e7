"""A system as a job for foreign hosts, and what our own master makes of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from host_job import Job
from numpy.typing import NDArray

from cosim.engine.loader import Loader
from cosim.engine.master import Master
from cosim.engine.schedule import schedule
from cosim.model.assembly import Node, assemble
from cosim.model.system import System
from cosim.results.recorder import recorded
from scenarios.shared.catalogue import fmu_path

Answer = NDArray[np.float64]


def ask(system: System, step: float, steps: int, every: int) -> tuple[Job, Answer]:
    """The job, and our answer to it."""
    with Loader(fmu_path) as loader:
        nodes = assemble(system, loader.faces(system), 0, step)
        master = Master(nodes, schedule(nodes, "jacobi"), loader.slaves(system, nodes))
        chosen = recorded(master.signals)
        signals = [(master.signals[i].instance, master.signals[i].variable) for i in chosen]
        master.initialise()
        rows: list[Answer] = []
        places = [1 + i for i in chosen]
        outcome = master.run(round(step * 1e9) * steps, lambda: rows.append(master.vector[places]))
    assert outcome.status == "ok", outcome.reason
    job: Job = {"step": step, "steps": steps, "every": every, "connections": _connections(nodes)}
    job["instances"] = {name: _instance(node, fmu_path(system.instances[name].model)) for name, node in nodes.items()}
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
            assert c.conversion.trivial, f"{c.text}: these hosts are not told to convert units"
            output, input_ = nodes[c.source].face.ports[c.output], node.face.ports[c.input]
            found.append([c.source, c.output, output.reference, c.target, c.input, input_.reference])
    return found
