"""What a follower that makes up for the delay of its own car is told of it.

That is the delay of the yaw rate. A lead of the speed would differentiate the noise of the messages into commanded
accelerations five times as rough, and keep the cars no nearer to their places.
"""

from __future__ import annotations

from collections.abc import Iterable

from cosim.errors import CosimError
from cosim.model.face import Value
from cosim.model.system import System
from scenarios.formation.system import name

_LEADING = "ConstraintFollower"
_HOLD = 0.010
"""Half the period [s] of a follower: a command that is held comes that much late."""
_LONGEST = 0.5  # s, the largest lead there is


def tell_the_leads(system: System, cars: Iterable[int]) -> None:
    """`lead.yaw_rate` of the followers becomes the delay of the yaw rate they command, unless set by hand."""
    for k in cars:
        follower = system.instances[f"{name(k)}follower"]
        if follower.model == _LEADING:
            follower.parameters.setdefault("lead.yaw_rate", min(_HOLD + _delay(system, name(k)), _LONGEST))


def _delay(system: System, car: str) -> float:
    """That of the low-level controller: its D/S filter, 3/omega, and one of its samples; of a unicycle its lag [s]."""
    from fmus.controllers.low_level_pid.interface import INTERFACE as LOW_LEVEL  # noqa: PLC0415  (lazy: `cosim list`)
    from fmus.unicycle.interface import INTERFACE as UNICYCLE  # noqa: PLC0415

    llc = f"{car}llc"
    given, interface = (llc, LOW_LEVEL) if llc in system.instances else (f"{car}plant", UNICYCLE)
    values: dict[str, Value] = {v.name: v.start for v in interface.select("parameter")}
    values |= system.instances[given].parameters
    try:
        if interface is UNICYCLE:
            return float(values["yaw_rate.lag"])
        return 3.0 / max(float(values["filter.yaw_rate"]), 1e-9) + float(values["sample_period"])
    except ValueError:
        raise CosimError(f"a filter or lag of {given} is not a number") from None
