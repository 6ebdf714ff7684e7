"""What a follower that makes up for the delays of its own car is told of them."""

from __future__ import annotations

from collections.abc import Iterable

from cosim.errors import CosimError
from cosim.face import Value
from cosim.scenarios._formation import name
from cosim.system import System

_LEADING = "ConstraintFollower"
_HOLD = 0.010
"""Half the period [s] of a follower: a command that is held comes that much late."""
_LONGEST = 0.5  # s, the largest lead there is


def tell_the_leads(system: System, cars: Iterable[int]) -> None:
    """`lead.speed` and `lead.yaw_rate` of the followers become the delays of what they command, unless set by hand."""
    for k in cars:
        follower = system.instances[f"{name(k)}follower"]
        if follower.model == _LEADING:
            for command in ("speed", "yaw_rate"):
                lead = min(_HOLD + _delay(system, name(k), command), _LONGEST)
                follower.parameters.setdefault(f"lead.{command}", lead)


def _delay(system: System, car: str, command: str) -> float:
    """That of the low-level controller: its D/S filter, 3/omega, and one of its samples; of a unicycle its lag [s]."""
    from fmus.controllers.low_level_pid.interface import INTERFACE as LOW_LEVEL  # noqa: PLC0415  (lazy: `cosim list`)
    from fmus.unicycle.interface import INTERFACE as UNICYCLE  # noqa: PLC0415

    llc = f"{car}llc"
    given, interface = (llc, LOW_LEVEL) if llc in system.instances else (f"{car}plant", UNICYCLE)
    values: dict[str, Value] = {v.name: v.start for v in interface.select("parameter")}
    values |= system.instances[given].parameters
    try:
        if interface is UNICYCLE:
            return float(values[f"{command}.lag"])
        return 3.0 / max(float(values[f"filter.{command}"]), 1e-9) + float(values["sample_period"])
    except ValueError:
        raise CosimError(f"a filter or lag of {given} is not a number") from None
