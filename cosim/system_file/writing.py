"""From a configured system to a system file, which runs to the same bits."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import msgspec
import tomli_w

from cosim.engine.loader import Loader
from cosim.errors import CosimError
from cosim.model.clock import to_seconds
from cosim.model.configuration import Configuration
from cosim.model.effects import Delay, Drop, Freeze, Linear, Noise, Override, Ramp, Table
from cosim.model.fault import Fault
from cosim.model.system import Event, Instance, Link, System, Wire
from cosim.model.transformation import Lookup
from cosim.run.prepare import RunPlan, plan
from cosim.run.request import Request
from cosim.system_file.form import ConnectionForm, EventForm, InstanceForm, Scalar, SystemForm
from fmukit.errors import because
from fmukit.files import write


def export_system(request: Request, file: Path) -> Path:
    """Write what the request would run as `file` and return it; raises CosimError.

    Tables that String parameters name and FMUs that an SSP packs are copied into a folder beside it, called as the file
    without its suffix. The scenario's own metrics, limits and picture are code, which stays behind.
    """
    with Loader(request.find) as loader:
        made = plan(request, loader)
    tables: dict[str, Path] = {}
    form = _form(made, file, tables)
    text = tomli_w.dumps(msgspec.to_builtins(form))
    try:
        for name, table in tables.items():
            write(file.parent / name, table.read_bytes())
        return write(file, text.encode())
    except OSError as error:
        raise CosimError(f"cannot write {file}: {because(error)}") from None


def _form(made: RunPlan, file: Path, tables: dict[str, Path]) -> SystemForm:
    request, configuration = made.request, made.configured.configuration
    system = configuration.system
    return SystemForm(
        name=request.scenario.name,
        title=request.scenario.title,
        stop_time=to_seconds(request.stop),
        record_every=to_seconds(request.interval),
        unrecorded=list(request.scenario.unrecorded),
        instances={
            name: _instance(system, instance, _kept(configuration, name, file.stem, tables), file, tables)
            for name, instance in system.instances.items()
        },
        connections=[*map(_wire, system.wires), *(_link(link) for link in system.links)],
        events=[*_events(system.events), *map(fault_form, system.faults)],
    )


def _instance(
    system: System, instance: Instance, values: dict[str, Scalar], file: Path, copies: dict[str, Path]
) -> InstanceForm:
    model = instance.model
    own = system.files.get(model)
    if own is not None and str(own) != model:  # unpacked, for as long as the run lasts
        model = _copied(own, file.stem, copies, ".fmu")
    elif model.endswith(".fmu"):
        path, here = Path(model).resolve(), file.parent.resolve()
        model = str(path.relative_to(here)) if path.is_relative_to(here) else str(path)
    return InstanceForm(model, instance.period, instance.kind, values)


def _kept(configuration: Configuration, name: str, folder: str, tables: dict[str, Path]) -> dict[str, Scalar]:
    """The values set of an instance, those that name files as their copies in `folder`."""
    ports = configuration.faces[name].ports
    values: dict[str, Scalar] = dict(configuration.changed(name))
    for variable, value in values.items():
        if ports[variable].type == "String" and value and Path(str(value)).is_file():
            values[variable] = _copied(Path(str(value)), folder, tables)
    return values


def _copied(file: Path, folder: str, copies: dict[str, Path], suffix: str | None = None) -> str:
    """Where the copy of a file goes, relative to the system file; numbered where another file has its name."""
    suffix = file.suffix if suffix is None else suffix
    name, number = f"{folder}/{file.stem}{suffix}", 1
    while copies.setdefault(name, file) != file:
        number += 1
        name = f"{folder}/{file.stem}-{number}{suffix}"
    return name


def _wire(wire: Wire) -> ConnectionForm:
    names = None if wire.names == {"": ""} else dict(wire.names)
    return ConnectionForm(wire.source, wire.target, names, wire.lenient)


def _link(link: Link) -> ConnectionForm:
    form = ConnectionForm(f"{link.source}.{link.output}", f"{link.target}.{link.input}")
    if link.transformation is None:
        return form
    steps = link.transformation.steps
    if not steps:
        form.factor = 1.0  # instead of a conversion of units
    for step in steps:
        if isinstance(step, Lookup):
            form.map, form.partial = {str(source): target for source, target in step.entries}, step.partial
        else:
            form.factor, form.offset = step.factor, step.offset
    if [isinstance(step, Lookup) for step in steps] not in ([], [True], [False], [True, False]):
        raise CosimError(f"{form.source} -> {form.target}: a system file has no place for these steps on the way")
    return form


def fault_form(fault: Fault) -> EventForm:
    """One event; the steps of a table stand in it."""
    form = EventForm(fault.begin, signal=fault.signal, until=fault.end, when=fault.condition)
    match fault.effect:
        case Override(value):
            form.override = value
        case Ramp(value, duration):
            form.ramp_to, form.over = value, duration
        case Table(times, values):
            form.table = [list(row) for row in zip(times, values, strict=True)]
        case Linear(factor, bias):
            form.scale, form.bias = factor, bias
        case Noise(sigma):
            form.noise = sigma
        case Freeze():
            form.freeze = True
        case Delay(duration):
            form.delay = duration
        case Drop(probability):
            form.drop = probability
    return form


def _events(events: Iterable[Event]) -> list[EventForm]:
    """Events of one time together, in their order."""
    at: dict[float, dict[str, Any]] = {}
    for event in events:
        at.setdefault(event.time, {})[event.signal] = event.value
    return [EventForm(time, set=dict(values)) for time, values in sorted(at.items())]
