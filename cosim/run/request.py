"""What a user asks for: a scenario with values, events, a seed and a folder for its results."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from cosim.engine.loader import ISOLATION_TIMEOUT
from cosim.engine.models import find
from cosim.engine.schedule import Scheme
from cosim.errors import CosimError
from cosim.model.clock import nanoseconds
from cosim.results.checkpoint import Resumed
from cosim.scenario.definition import Scenario

FAULT = "**.fault"
"""Boolean outputs of the catalogue's FMUs that are false as long as a run goes on; fetching them would take time."""

_LONGEST = 1e6


@dataclass(frozen=True, slots=True)
class Request:
    """One run to be made; raises CosimError for times that cannot be.

    `assignments` are (instance.variable or scenario.setting, text); `events` are (time [s], instance.variable, text),
    besides those of the scenario. `step` [s] is one communication step for all instances instead of a period for each.
    `stop_time` and `record_every` [s] take the place of the scenario's. `record_all` records what the scenario leaves
    out. `find` gives the .fmu file of a model by its name.
    `isolate` are patterns of instances that get processes of their own (see `System.isolate`), each call of which may
    take `isolate_timeout` [s] of wall time. `periods` are (pattern of instances, period [s]), the last counts.
    `replacements` are (instance or pattern of such, .fmu file): see `cosim.run.replacing`. `event_files` are files of
    events, or names of those that packages offer. `realtime` are simulated seconds per second of the wall to keep to.
    A `checkpoint` is kept every so many [s]; the run goes on from where another was with `resume`. `origin` is what the
    user named, if that is not the name of the scenario.
    """

    scenario: Scenario
    folder: Path
    assignments: Sequence[tuple[str, str]] = ()
    seed: int = 0
    stop_time: float | None = None
    scheme: Scheme = "multirate"
    step: float | None = None
    events: Sequence[tuple[float, str, str]] = ()
    record_every: float | None = None
    record_all: bool = False
    find: Callable[[str], Path] = find
    isolate: Sequence[str] = ()
    isolate_timeout: float = ISOLATION_TIMEOUT
    periods: Sequence[tuple[str, float]] = ()
    replacements: Sequence[tuple[str, Path]] = ()
    event_files: Sequence[str] = ()
    realtime: float | None = None
    checkpoint: float | None = None
    resume: Resumed | None = None
    origin: str = ""

    def __post_init__(self) -> None:
        _ = (
            self.stop,
            self.interval,
            self.checkpoint_interval,
        )  # before anything is prepared, or removed from the folder
        if not 1e-3 <= self.isolate_timeout <= _LONGEST:
            raise CosimError(f"the time-out of isolated instances is {self.isolate_timeout:g} s; give 0.001 to 1e6 s")

        if self.realtime is not None and not 0.0 < self.realtime <= _LONGEST:
            raise CosimError(f"the pace is {self.realtime:g} x real time; give a positive number")

    @property
    def stop(self) -> int:
        """The end of the run [ns]."""
        seconds = self.scenario.stop_time if self.stop_time is None else self.stop_time
        return nanoseconds(seconds, "the stop time")

    @property
    def checkpoint_interval(self) -> int:
        """The time between two checkpoints [ns], 0 for none."""
        return nanoseconds(self.checkpoint, "the time between two checkpoints") if self.checkpoint is not None else 0

    @property
    def interval(self) -> int:
        """The time between two recorded rows [ns], 0 for a row at every tick."""
        seconds = self.scenario.record_every if self.record_every is None else self.record_every
        return nanoseconds(seconds, "the time between two recorded rows") if seconds else 0

    @property
    def unrecorded(self) -> Sequence[str]:
        """Patterns of the signals that are left out of the results."""
        return () if self.record_all else (FAULT, *self.scenario.unrecorded)
