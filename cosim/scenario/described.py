"""Scenarios that are files: a system somebody described, without code of its own."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field

from cosim.errors import unknown
from cosim.model.configuration import LOOK, Configuration
from cosim.model.patterns import matches_any
from cosim.model.system import System
from cosim.scenario.definition import Scenario, Work
from cosim.scenario.limit import Limit
from cosim.scenario.measure import Measure, measured


@dataclass(frozen=True, slots=True)
class Description:
    """What a file says: a system, how long it runs, and what its run is worth.

    `stop_time` and `record_every` are in seconds. Models are paths to .fmu files or names of models that are offered.
    """

    name: str
    title: str
    system: System
    stop_time: float
    record_every: float = 0.0
    unrecorded: tuple[str, ...] = ()
    measures: dict[str, Measure] = field(default_factory=dict)
    limits: tuple[Limit, ...] = ()


def scenario_of(said: Description) -> Scenario:
    """A scenario that runs what a file says; every run works on a copy of its system."""
    work = Work(
        build=lambda _settings, _prepared: deepcopy(said.system),
        complete=lambda configuration, _prepared: _check(said.measures, configuration),
        metrics=lambda results, _prepared: measured(said.measures, results),
        limits=said.limits,
    )
    return Scenario(
        said.name,
        said.title,
        "",
        said.stop_time,
        made=work,
        record_every=said.record_every,
        unrecorded=said.unrecorded,
    )


def _check(measures: Mapping[str, Measure], configuration: Configuration) -> None:
    """Raises CosimError for a measure of a signal that is no recorded number."""
    system = configuration.system
    changed = [event.signal for event in system.events] + [fault.signal for fault in system.faults]
    for measure in measures.values():
        for signal in filter(None, (measure.signal, measure.minus)):
            instance, variable = system.split(signal)
            face = configuration.faces[instance]
            if variable not in face.numbers and not matches_any(signal, changed):
                raise unknown(f"output of {instance} ({face.model}) that is a number", variable, face.numbers, LOOK)
