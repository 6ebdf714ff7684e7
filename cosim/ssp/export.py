"""A system as SSP 1.0: SystemStructure.ssd with the FMUs and one set of parameter values per instance in resources/.

Other tools read everything they need from it. What SSP 1.0 has no place for, such as the communication period of an
instance and values that change during the run, is an annotation of type "cosim". A table that a String parameter names
travels in the FMU that reads it.
"""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping
from pathlib import Path

from cosim.engine.loader import Loader
from cosim.errors import CosimError
from cosim.model.node import Node
from cosim.run.prepare import plan
from cosim.run.request import Request
from cosim.ssp.names import free_name, identifiers
from cosim.ssp.packing import Model, packed, table_of
from cosim.ssp.places import DEFAULT
from cosim.ssp.writing import Outline, structure, values
from fmukit.errors import because
from fmukit.files import write
from fmukit.packing import pack

_LOG = logging.getLogger("cosim")


def export(request: Request, file: Path) -> Path:
    """Write the scenario as `file` (.ssp) and return it; raises CosimError. Equal requests give equal bytes."""
    with Loader(request.find) as loader:
        made = plan(request, loader)
        nodes = made.nodes
        models = _models({name: (node, loader.file(node.model)) for name, node in nodes.items()})
        members = {f"resources/{model.name}": packed(model) for model in models.values()}
    sets = _sets(nodes.values())
    scenario = request.scenario
    outline = Outline(
        scenario.name, nodes, models, sets, identifiers(nodes), request.stop, made.schedule.tick, request.interval
    )
    _tell_what_is_lost(nodes.values())
    members[DEFAULT] = structure(outline, scenario.unrecorded)
    members |= {member: values(nodes[name]) for name, member in sets.items()}
    try:
        return write(file, pack(members))
    except OSError as error:
        raise CosimError(f"cannot write {file}: {because(error)}") from None


def _models(files: Mapping[str, tuple[Node, Path]]) -> dict[str, Model]:
    """A name of its own in resources/ for every file and table: the file's, numbered where two share it."""
    made: dict[object, Model] = {}
    models: dict[str, Model] = {}
    for instance, (node, file) in files.items():
        table = table_of(node, file)
        if (file, table) not in made:
            taken = {model.name.casefold() for model in made.values()}
            made[file, table] = Model(file, free_name(file.stem, ".fmu", taken), table)
        models[instance] = made[file, table]
    return models


def _sets(nodes: Iterable[Node]) -> dict[str, str]:
    """The member that holds the parameter set of each instance with values of its own."""
    names: dict[str, str] = {}
    for node in nodes:
        if node.values:
            names[node.name] = free_name(node.name, ".ssv", {name.casefold() for name in names.values()})
    return {instance: f"resources/{name}" for instance, name in names.items()}


def _tell_what_is_lost(nodes: Iterable[Node]) -> None:
    nodes = list(nodes)
    count = sum(len(node.changes) for node in nodes)
    if count:
        said = "1 value that changes" if count == 1 else f"{count} values that change"
        _LOG.warning("SSP 1.0 has no place for %s during the run: an annotation keeps it, other tools ignore it", said)
    faulty = [f"{node.name}.{name}" for node in nodes for name in node.faults]
    if faulty:
        _LOG.warning("SSP 1.0 has no place for faults: those of %s stay behind", ", ".join(faulty))
    texts = [f"{node.name}.{name}" for node in nodes for name in node.values if node.face.ports[name].type == "String"]
    if texts:
        _LOG.warning("OMSimulator reads no values of Strings, and here needs %s set by hand", " and ".join(texts))
