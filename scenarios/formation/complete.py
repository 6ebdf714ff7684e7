"""What follows in a formation from the values the user set: where the cars start, and what is known of their delays.

A follower that makes up for the delay of its own car is told that of the yaw rate, and one whose command is a speed
that of the speed. With commands that are integrated accelerations, a lead of the speed would differentiate the noise of
the messages into accelerations five times as rough, and keep the cars no nearer to their places.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from cosim.model.configuration import Configuration
from scenarios.formation.advice import advise
from scenarios.formation.start import start_in_formation
from scenarios.formation.timetable import Formation
from scenarios.formation.topology import HEAD, prefix
from scenarios.shared.actuator import tell_the_actuator

LED = {"AdaptiveFollower": ("yaw_rate", "speed"), "ConstraintFollower": ("yaw_rate",)}
"""By model of the follower: the delays of its car it makes up for."""
_REMEDIES = "use scenario.frame=head, or give scenario.headway"
_HOLD = 0.010
"""Half the period [s] of a follower: a command that is held comes that much late."""
_LONGEST = 0.5  # s, the largest lead there is


def complete_formation(
    configuration: Configuration,
    formation: Formation,
    led: Mapping[str, Sequence[str]] = LED,
    remedies: str = _REMEDIES,
) -> Formation:
    """Start the cars in their places, and tell the head's controller and the followers what delays their cars have.

    Where errors will grow from car to car, that and `remedies` are said. `led` are the delays followers make up for.
    """
    start_in_formation(configuration, formation)
    if f"{prefix(HEAD)}llc" in configuration:
        tell_the_actuator(configuration, prefix(HEAD))
    _tell_the_leads(configuration, formation.leaders, led)
    advise(configuration, formation, remedies)
    return formation


def _tell_the_leads(configuration: Configuration, followers: Iterable[int], led: Mapping[str, Sequence[str]]) -> None:
    """`lead.*` become the delays of what the follower commands, unless set by hand; `led` says which of its model."""
    for k in followers:
        follower = f"{prefix(k)}follower"
        for what in led.get(configuration.model(follower), ()):
            lead = min(_HOLD + _delay(configuration, prefix(k), what), _LONGEST)
            configuration.default(follower, f"lead.{what}", lead)


def _delay(configuration: Configuration, car: str, what: str) -> float:
    """That of the low-level controller: its D/S filter, 3/omega, and one of its samples; of a unicycle its lag [s]."""
    llc = f"{car}llc"
    if llc not in configuration:
        return configuration.number(f"{car}plant", f"{what}.lag")
    return 3.0 / configuration.number(llc, f"filter.{what}") + configuration.number(llc, "sample_period")
