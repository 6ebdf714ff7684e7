"""A scenario in two parts: `Scenario` says what it is and is light to import, `Work` is what it does.

A scenario names the module of its work, which is imported only when it runs. The steps of a run are functions of the
work, in this order:

    prepared = prepare(settings)                what is made once, before the system: a plan, a road, a decision
    system = build(settings, prepared)          instances and wires
    prepared = complete(configuration, prepared)    what follows from the values the user set, as defaults of others
    metrics(results, prepared)                  what the run is worth
    limits                                      what metrics have to keep to, or the mission is missed
    failure(results, prepared)                  why it failed all the same, one sentence, or nothing
    draw(results, prepared, file, title)        its picture

`prepared` is of the scenario's own type; all later steps get the same object, so nothing is worked out twice.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cosim.errors import CosimError
from cosim.scenario.limit import Limit
from cosim.scenario.metric import Metrics
from cosim.scenario.settings import NumberSetting, Setting, Settings

if TYPE_CHECKING:
    from cosim.model.configuration import Configuration
    from cosim.model.system import System
    from cosim.results.reading import Results


@dataclass(frozen=True, slots=True)
class Scenario:
    """What a scenario is. `figures` names what of the thesis it reproduces.

    `module` is the dotted name of the module whose `WORK` it does, unless it has `made` work. `stop_time` [s] is the
    end of the run unless the user gives another. A row is recorded every `record_every` [s]; 0 is at every tick.
    Signals that fit a pattern of `unrecorded`, such as **.tyre_force_x.fl, are left out of the results.
    """

    name: str
    title: str
    figures: str
    stop_time: float
    module: str = ""
    settings: Mapping[str, Setting | NumberSetting] = field(default_factory=dict)
    record_every: float = 0.0
    unrecorded: Sequence[str] = ()
    made: Work | None = None

    def work(self) -> Work:
        """What the scenario does; imports its module. Raises CosimError when that cannot be."""
        if self.made is not None:
            return self.made
        try:
            work: Work = import_module(self.module).WORK
        except (ImportError, AttributeError) as error:
            raise CosimError(f"the scenario {self.name} cannot be loaded from {self.module}: {error}") from None
        return work


def _nothing(_settings: Settings) -> Any:
    return None


def _as_it_is(_configuration: Configuration, prepared: Any) -> Any:
    return prepared


def _none(_results: Results, _prepared: Any) -> str:
    return ""


def _no_metrics(_results: Results, _prepared: Any) -> Metrics:
    return {}


@dataclass(frozen=True, slots=True)
class Work:
    """What a scenario does, step by step (see the module).

    A run that went to its end has the status "missed" when a metric is beyond one of the `limits`, and "failed" when
    `failure` has a sentence for it. `picture` is the
    dotted name of the module with `draw(results, prepared, file, title)`, imported only when there is something to
    draw; without it there is no picture.
    """

    build: Callable[[Settings, Any], System]
    prepare: Callable[[Settings], Any] = _nothing
    complete: Callable[[Configuration, Any], Any] = _as_it_is
    metrics: Callable[[Results, Any], Metrics] = _no_metrics
    limits: Sequence[Limit] = ()
    failure: Callable[[Results, Any], str] = _none
    picture: str | None = None

    def draw(self, results: Results, prepared: Any, file: Path, title: str) -> None:
        """Draw the results into `file`; does nothing without a picture. Raises OSError when it cannot be written."""
        if self.picture is not None:
            import_module(self.picture).draw(results, prepared, file, title)
