"""From what a user asks for to what is going to run: everything that can be wrong before the run is found here."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from cosim.engine.loader import Loader
from cosim.engine.models import declared, find
from cosim.engine.pace import Pace
from cosim.engine.schedule import Schedule, schedule
from cosim.errors import CosimError
from cosim.model.assembly import assemble, changing, leave_out
from cosim.model.clock import SECOND, to_seconds
from cosim.model.configuration import Configuration, selected
from cosim.model.node import Node
from cosim.model.system import System
from cosim.model.values import coerce
from cosim.results.provenance import Provenance
from cosim.run.remarks import remarks
from cosim.run.replacing import Replaced, misfits, replaced
from cosim.run.request import Request
from cosim.run.tracing import provenance
from cosim.scenario.definition import Work
from cosim.scenario.settings import PREFIX, Settings, chosen

_LOG = logging.getLogger("cosim")


@dataclass(frozen=True, slots=True)
class Configured:
    """A scenario's system with the values it starts with, and what the scenario prepared on the way.

    `originals` are the instances whose places FMUs of the user have taken.
    """

    work: Work
    settings: Settings
    configuration: Configuration
    prepared: Any
    originals: Mapping[str, Replaced] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class RunPlan:
    """What is going to run: the checked nodes of a configured system, in which order they do, and at which pace."""

    request: Request
    configured: Configured
    nodes: dict[str, Node]
    schedule: Schedule
    provenance: Provenance = field(default_factory=Provenance)
    pace: Pace | None = None


def plan(request: Request, loader: Loader) -> RunPlan:
    """Prepare the run; raises CosimError for any mistake of the user."""
    made = configured(request, loader)
    nodes = assemble(made.configuration, request.seed, request.step)
    _in_time(request, nodes)
    leave_out(nodes, request.unrecorded)
    order = schedule(nodes, request.scheme)
    _whole_steps(request, nodes, order)
    for remark in (*remarks(made.configuration.system, nodes), *misfits(made.originals, nodes)):
        _LOG.warning("%s", remark)
    files = {node.model: loader.file(node.model) for node in nodes.values()}
    pace = None if request.realtime is None else Pace(request.realtime)
    return RunPlan(request, made, nodes, order, provenance(request, made.settings, nodes, files), pace)


def configured(request: Request, loader: Loader) -> Configured:
    """The scenario's system with the user's values and events, and what the scenario makes of them."""
    settings = chosen(request.scenario.name, request.scenario.settings, request.assignments)
    work = request.scenario.work()
    prepared = work.prepare(settings)
    system = work.build(settings, prepared)
    originals = replaced(system, request.replacements, loader)
    requested(system, request)
    if request.find is find:
        _check_declared(system)
    faces = loader.faces(system)
    gone = {name: original.gone(faces[name]) for name, original in originals.items()}
    configuration = Configuration(system, faces, gone)
    return Configured(work, settings, configuration, work.complete(configuration, prepared), originals)


def _check_declared(system: System) -> None:
    """Raises CosimError for what cannot be set of models whose declaration is known, before any of them is built."""
    own = system.files  # models that the system brings along, whatever their names
    faces = {
        name: None if instance.model in own else declared(instance.model) for name, instance in system.instances.items()
    }
    known = {name: face for name, face in faces.items() if face is not None}
    if len(known) < len(faces):
        return
    Configuration(system, known)
    for event in system.events:
        for name, variable in selected(system, known, event.signal, ("input",)):
            coerce(event.signal, changing(name, known[name], variable), event.value)


def requested(system: System, request: Request) -> System:
    """The scenario's system with what the user sets of it before the start and during the run."""
    for signal, text in request.assignments:
        if not signal.startswith(PREFIX):
            system.set(signal, text)
    for file in request.event_files:
        from cosim.system_file.events import add_events_of  # noqa: PLC0415 - only for those who have such a file

        add_events_of(file, system)
    for time, signal, text in request.events:
        system.at(time, signal, text)
    for pattern, period in request.periods:
        system.pace(pattern, period)
    for pattern in request.isolate:
        system.isolate(pattern)
    return system


def _whole_steps(request: Request, nodes: Mapping[str, Node], order: Schedule) -> None:
    """Raises CosimError where the last step would be cut short of a model that takes whole steps only."""
    for name in order.parallel:
        node = nodes[name]
        left = request.stop % node.period
        if left and node.face.whole_steps:
            stop, before, period = (to_seconds(time) for time in (request.stop, request.stop - left, node.period))
            raise CosimError(
                f"the run ends at {stop:g} s, within a step of {name}, which takes only whole steps of {period:g} s; "
                f"end it at {before:g} or {before + period:g} s"
            )


def _in_time(request: Request, nodes: Mapping[str, Node]) -> None:
    """Raises CosimError for an event of the user that the run would not reach; those of a scenario may be cut off."""
    stop, asked = request.stop, {(round(time * SECOND), signal) for time, signal, _ in request.events}
    for node in nodes.values():
        for change in node.changes:
            if (change.time, change.signal) in asked and change.due >= stop:
                raise CosimError(
                    f"{node.name}.{change.variable} cannot be set at {to_seconds(change.time):g} s: "
                    f"the run ends at {to_seconds(stop):g} s, "
                    f"and {node.name} would take it in at {to_seconds(change.due):g} s"
                )
