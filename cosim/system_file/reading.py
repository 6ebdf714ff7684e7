"""From a system file to what it describes."""

from __future__ import annotations

import math
from pathlib import Path

from cosim.errors import CosimError
from cosim.model.patterns import captured, is_pattern, substituted
from cosim.model.system import System
from cosim.model.transformation import AS_IT_IS, Lookup, Transformation
from cosim.model.units import Conversion
from cosim.scenario.described import Description
from cosim.scenario.limit import Limit
from cosim.scenario.measure import Measure
from cosim.system_file.decoding import read_form
from cosim.system_file.events import add_events
from cosim.system_file.form import ConnectionForm, InstanceForm, MetricForm, Scalar, SystemForm

_BOOLEANS = {"false": "0", "true": "1"}


def read_system(file: Path) -> Description:
    """What the system file says; raises CosimError with the place of a mistake."""
    form = read_form(file, SystemForm)
    system = System()
    for name, instance in form.instances.items():
        _add(system, name, instance, file.parent)
    for number, connection in enumerate(form.connections, start=1):
        _connect(system, connection, f"{file}, connection {number}")
    add_events(system, form.events, file)
    for key, metric in form.metrics.items():
        _check(key, metric, file)
    name = form.name or file.stem
    return Description(
        name,
        form.title or name,
        system,
        form.stop_time,
        form.record_every,
        tuple(form.unrecorded),
        {key: Measure(metric.signal, metric.of, metric.minus, metric.after) for key, metric in form.metrics.items()},
        tuple(_limit(key, metric) for key, metric in form.metrics.items() if _limited(metric)),
    )


def _add(system: System, name: str, form: InstanceForm, folder: Path) -> None:
    model = str(folder / form.model) if form.model.endswith(".fmu") else form.model
    parameters = {key: _beside(value, folder) for key, value in form.parameters.items()}
    system.add(name, model, parameters, form.period, form.kind)


def _beside(value: Scalar, folder: Path) -> Scalar:
    """A text that names a file beside the system file is the path of that file."""
    if isinstance(value, str) and value and not Path(value).is_absolute() and (folder / value).is_file():
        return str(folder / value)
    return value


def _connect(system: System, form: ConnectionForm, where: str) -> None:
    if is_pattern(form.target):
        return _connect_all(system, form, where)
    if form.target in system.instances:
        if form.factor is not None or form.offset is not None or form.map is not None:
            raise CosimError(f"{where}: factor, offset and map need signals, not instances, in from and to")
        return system.connect(form.source, form.target, form.names, lenient=form.lenient)
    if form.names is not None:
        raise CosimError(f"{where}: names need instances in from and to; {form.target} is no instance")
    return system.link(system.split(form.source), system.split(form.target), _transformation(form, where))


def _connect_all(system: System, form: ConnectionForm, where: str) -> None:
    """Every instance that `to` fits, from the instance that `from` names with the same text for each wildcard."""
    found = [(name, captured(name, form.target)) for name in system.instances]
    pairs = [(substituted(form.source, texts), name) for name, texts in found if texts is not None]
    if not pairs:
        raise CosimError(f"{where}: no instance fits the pattern {form.target!r}")
    for source, target in pairs:
        if source != target:
            system.connect(source, target, form.names, lenient=form.lenient)


def _transformation(form: ConnectionForm, where: str) -> Transformation | None:
    """None, that by the units, where the connection says nothing."""
    if form.map is None and form.factor is None and form.offset is None:
        return None
    made = AS_IT_IS
    if form.map is not None:
        entries = tuple((_whole(key, where), int(value)) for key, value in form.map.items())
        made = made.then(Lookup(entries, form.partial))
    factor = 1.0 if form.factor is None else form.factor
    return made.then(Conversion(factor, form.offset or 0.0))


def _whole(key: str, where: str) -> int:
    try:
        return int(_BOOLEANS.get(key, key))
    except ValueError:
        raise CosimError(f"{where}: the map has {key!r}; give whole numbers, true or false") from None


def _check(name: str, form: MetricForm, file: Path) -> None:
    if any(map(math.isnan, (form.after, form.at_most, form.at_least))):
        raise CosimError(f"{file}, metric {name}: after, at_most and at_least must be numbers")


def _limited(form: MetricForm) -> bool:
    return (form.at_most, form.at_least) != (float("inf"), float("-inf"))


def _limit(name: str, form: MetricForm) -> Limit:
    return Limit(form.words or f"{name} is out of its limits", name, form.at_most, form.at_least)
