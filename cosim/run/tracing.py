"""The provenance of a run that is prepared."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path

from cosim.model.clock import to_seconds
from cosim.model.face import Value
from cosim.model.node import Node
from cosim.results.provenance import Model, Provenance, versions
from cosim.run.request import Request
from cosim.scenario.settings import Settings


def provenance(
    request: Request, settings: Settings, nodes: Mapping[str, Node], files: Mapping[str, Path]
) -> Provenance:
    """What the run is made of; `files` are the FMUs by the name of the model."""
    tools = {node.model: node.face.tool for node in nodes.values()}
    return Provenance(
        settings=dict(settings),
        set=[f"{signal}={value}" for signal, value in request.assignments],
        at=[f"{time:g}:{signal}={value}" for time, signal, value in (*request.events, *_branched(request))],
        events=[_event_file(name) for name in request.event_files],
        replaced=[f"{name}={file.name}" for name, file in request.replacements],
        faults=[
            f"{node.name}.{name}: {fault.effect} from {fault.begin:g} to {fault.end:g} s {fault.condition}".rstrip()
            for node in nodes.values()
            for name, faults in node.faults.items()
            for fault in faults
        ],
        values=dict(_changed(nodes)),
        periods=[f"{pattern}={period!r}" for pattern, period in request.periods],
        seed=request.seed,
        stop=to_seconds(request.stop),
        scheme=request.scheme,
        step=request.step,
        models={
            name: Model(file.name, sha256(file.read_bytes()).hexdigest(), tools[name]) for name, file in files.items()
        },
        versions=versions(),
    )


def _branched(request: Request) -> Iterator[tuple[float, str, Value]]:
    """What was set where the run went on from a checkpoint."""
    again = request.resume
    for signal, value in again.changes if again else ():
        yield to_seconds(again.checkpoint.moment.time) if again else 0.0, signal, value


def _event_file(name: str) -> str:
    file = Path(name)
    return f"{file.name} {sha256(file.read_bytes()).hexdigest()}" if name.endswith(".toml") else name


def _changed(nodes: Mapping[str, Node]) -> Iterator[tuple[str, Value]]:
    for node in nodes.values():
        for variable, value in node.values.items():
            if value != node.face.ports[variable].start:
                yield f"{node.name}.{variable}", value
