"""A replay: the log becomes tables that inputs follow, and outputs are held against its columns."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cosim.engine.loader import Loader
from cosim.engine.models import find
from cosim.errors import CosimError, unknown
from cosim.model.configuration import LOOK, names
from cosim.model.effects import Table
from cosim.model.face import Face
from cosim.model.fault import Fault
from cosim.model.system import System
from cosim.model.units import Unit
from cosim.replay.columns import Measured, inputs, measured, time_of
from cosim.replay.errors import Error, error
from cosim.replay.form import MapForm
from cosim.replay.log import read_log
from cosim.run.request import Request
from cosim.run.running import Finished, run
from cosim.scenario.described import Description, scenario_of
from cosim.system_file.decoding import read_form
from cosim.system_file.reading import read_system
from fmukit import files

ERRORS = "replay.json"
_GRAIN = 1e-6
"""[s] A replay lasts a whole number of these."""


@dataclass(frozen=True, slots=True)
class Replayed:
    """The run, the errors of what was compared, and for each of these the log in the unit of the signal."""

    finished: Finished
    errors: Sequence[Error]
    logged: Mapping[str, Measured]


def replay(log_file: Path, map_file: Path, folder: Path, **options: Any) -> Replayed:
    """Replay the log into the results `folder`, with the options of a `Request`; raises CosimError.

    The folder then holds the errors as JSON beside what every run writes.
    """
    form = read_form(map_file, MapForm)
    log = read_log(log_file, form)
    time = time_of(log, form)
    system = _system(form, map_file)
    with Loader(options.get("find", find)) as loader:
        faces = loader.faces(system)
    for port, column in inputs(log, form, time):
        system.fail(Fault(port, _table(column, _unit(system, faces, port, "input"))))
    compared = {
        signal: _in_unit(measured(log, column, time), _unit(system, faces, signal, "output"))
        for signal, column in form.compare.items()
    }
    stop = form.duration if form.duration is not None else float(time[np.isfinite(time)].max())
    scenario = scenario_of(
        Description(log_file.stem, f"{log_file.name} replayed", system, math.floor(stop / _GRAIN) * _GRAIN)
    )
    finished = run(Request(scenario, folder, **options))
    results = finished.results
    found = [
        error(signal, results.unit(signal), results.time, results[signal], column, form.longest_lag)
        for signal, column in compared.items()
    ]
    files.write(folder / ERRORS, json.dumps([asdict(each) for each in found], indent=2).encode())
    return Replayed(finished, found, compared)


def _system(form: MapForm, file: Path) -> System:
    if bool(form.system) == bool(form.model):
        raise CosimError(f"{file}: give either a system or a model")
    if form.system:
        system = read_system(file.parent / form.system).system
        for signal, value in form.parameters.items():
            system.set(signal, value)
        return system
    system = System()
    model = str(file.parent / form.model) if form.model.endswith(".fmu") else form.model
    system.add(Path(form.model).stem.lower(), model, form.parameters, form.period)
    return system


def _unit(system: System, faces: Mapping[str, Face], signal: str, causality: str) -> Unit:
    instance, variable = system.split(signal)
    face = faces[instance]
    if variable not in names(face, causality):
        raise unknown(f"{causality} of {instance} ({face.model})", variable, names(face, causality), LOOK)
    return face.unit(variable) or Unit("")


def _in_unit(column: Measured, unit: Unit) -> Measured:
    offset = 0.0 if unit.relative else unit.offset
    return Measured(column.times, (column.values - offset) / unit.factor)


def _table(column: Measured, unit: Unit) -> Table:
    made = _in_unit(column, unit)
    return Table(tuple(made.times.tolist()), tuple(made.values.tolist()))
