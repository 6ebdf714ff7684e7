"""A run between two ticks: all that it needs to go on from there, to the bit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from cosim.engine.bound import Bound
from cosim.engine.shaping import Shaper
from cosim.engine.slave import Restorable, Slave
from cosim.errors import CosimError
from cosim.model.signals import Vector


@dataclass(frozen=True, slots=True)
class Moment:
    """Just before the tick at `time` [ns]: all signals, the outputs that wait for the end of their steps, FMU states.

    `signals` names the vector after its first element, the time. `held` and `said` are those outputs by instance, and
    `acting` is what lasts of faults, by instance.
    """

    time: int
    vector: Vector
    texts: Sequence[str]
    held: Mapping[str, Vector]
    said: Mapping[str, Sequence[str]]
    acting: Mapping[str, Sequence[Any]]
    states: Mapping[str, bytes]
    signals: Sequence[str]


def check_restorable(slaves: Mapping[str, Slave]) -> None:
    """Raises CosimError when a slave cannot give its state."""
    unable = [name for name, slave in slaves.items() if not slave.face.restorable]
    if unable:
        raise CosimError(
            f"no checkpoints of this system: {', '.join(unable[:3])} cannot give the state of the FMU "
            f"(canGetAndSetFMUstate, canSerializeFMUstate)"
        )


def taken(
    time: int,
    vector: Vector,
    places: Mapping[str, int],
    texts: Sequence[str],
    bounds: Mapping[str, Bound],
    shapers: Mapping[str, list[Shaper]],
) -> Moment:
    """What there is now; raises SlaveError."""
    return Moment(
        time,
        vector.copy(),
        list(texts),
        {name: bound.held.copy() for name, bound in bounds.items()},
        {name: list(bound.said) for name, bound in bounds.items()},
        {name: [shaper.state() for shaper in own] for name, own in shapers.items() if own},
        {name: cast(Restorable, bound.slave).save() for name, bound in bounds.items()},
        list(places),
    )


def put_back(
    moment: Moment,
    vector: Vector,
    places: Mapping[str, int],
    texts: list[str],
    bounds: Mapping[str, Bound],
    shapers: Mapping[str, list[Shaper]],
) -> None:
    """Be as at the moment; signals it does not know stay as they are. Raises SlaveError."""
    vector[0] = moment.vector[0]
    for name, value in zip(moment.signals, moment.vector[1:], strict=True):
        vector[places[name]] = value
    texts[:] = moment.texts
    for name, bound in bounds.items():
        cast(Restorable, bound.slave).restore(moment.states[name])
        np.copyto(bound.held, moment.held[name])
        bound.said[:] = moment.said[name]
        for shaper, state in zip(shapers[name], moment.acting.get(name, ()), strict=True):
            shaper.put_back(state)
