"""The form of a system file: what may stand where, and of which type. docs/your-own-system.md describes it."""

from __future__ import annotations

import math
from typing import Literal

import msgspec

from cosim.scenario.measure import Statistic

Scalar = bool | int | float | str


class InstanceForm(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    """One instance; `model` is a path relative to the file, or the name of a model that is offered; `period` [s]."""

    model: str
    period: float | None = None
    kind: Literal["continuous", "sampled"] | None = None
    parameters: dict[str, Scalar] = {}


class ConnectionForm(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    """Two instances, same name to same name or by `names`; or two signals, with a `factor`, an `offset` or a `map`.

    A factor or an offset stands instead of a conversion of units. `partial`: what the map does not name stays.
    Between two instances it may be `lenient`: names there are not are left out.
    """

    source: str = msgspec.field(name="from")
    target: str = msgspec.field(name="to")
    names: dict[str, str] | None = None
    lenient: bool = False
    factor: float | None = None
    offset: float | None = None
    map: dict[str, int | bool] | None = None
    partial: bool = False


class EventForm(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    """What happens from `time` to `until` [s], while `when` holds: unconnected inputs are `set`, or a signal changes.

    `signal` is an input, connected or not, with one effect; `ramp_to` needs `over` [s], `table` is a CSV file
    or its rows of time and value.
    """

    time: float = 0.0
    set: dict[str, Scalar] | None = None
    signal: str | None = None
    until: float = math.inf
    when: str = ""
    override: float | bool | None = None
    ramp_to: float | None = None
    over: float | None = None
    table: str | list[list[float]] | None = None
    scale: float | None = None
    bias: float | None = None
    noise: float | None = None
    freeze: bool = False
    delay: float | None = None
    drop: float | None = None


class EventsForm(msgspec.Struct, forbid_unknown_fields=True):
    """A file of events, for any system that has their signals; `parameters` are set before the start."""

    title: str = ""
    parameters: dict[str, Scalar] = {}
    events: list[EventForm] = []


class MetricForm(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    """One number of a signal, and the limits it has to keep; `words` say what has happened where it does not."""

    signal: str
    of: Statistic
    minus: str | None = None
    after: float = 0.0
    at_most: float = math.inf
    at_least: float = -math.inf
    words: str = ""


class SystemForm(msgspec.Struct, forbid_unknown_fields=True, omit_defaults=True):
    """The whole file; times in seconds."""

    stop_time: float
    instances: dict[str, InstanceForm]
    name: str = ""
    title: str = ""
    record_every: float = 0.0
    unrecorded: list[str] = []
    connections: list[ConnectionForm] = []
    events: list[EventForm] = []
    metrics: dict[str, MetricForm] = {}
