"""What follows in a formation from the values the user set: where the cars start, and what is known of their delays.

A follower that makes up for the delay of its own car is told that of the yaw rate, and one whose command is a speed
that of the speed. With commands that are integrated accelerations, a lead of the speed would differentiate the noise of
the messages into accelerations five times as rough, and keep the cars no nearer to their places.
"""

from __future__ import annotations

from collections.abc import Iterable

from cosim.model.configuration import Configuration
from scenarios.formation.start import start_in_formation
from scenarios.formation.timetable import Formation
from scenarios.formation.topology import HEAD, prefix
from scenarios.shared.actuator import tell_the_actuator

_LED_ALONG = "AdaptiveFollower"
_HOLD = 0.010
"""Half the period [s] of a follower: a command that is held comes that much late."""
_LONGEST = 0.5  # s, the largest lead there is


def complete_formation(configuration: Configuration, formation: Formation) -> Formation:
    """Start the cars in their places, and tell the head's controller and the followers what delays their cars have."""
    start_in_formation(configuration, formation)
    if f"{prefix(HEAD)}llc" in configuration:
        tell_the_actuator(configuration, prefix(HEAD))
    _tell_the_leads(configuration, formation.leaders)
    return formation


def _tell_the_leads(configuration: Configuration, followers: Iterable[int]) -> None:
    """`lead.yaw_rate`, and of adaptive followers `lead.speed`, become the delays of what the follower commands.

    What was set by hand stays.
    """
    for k in followers:
        follower = f"{prefix(k)}follower"
        led = ("yaw_rate", "speed") if configuration.model(follower) == _LED_ALONG else ("yaw_rate",)
        for what in led:
            lead = min(_HOLD + _delay(configuration, prefix(k), what), _LONGEST)
            configuration.default(follower, f"lead.{what}", lead)


def _delay(configuration: Configuration, car: str, what: str) -> float:
    """That of the low-level controller: its D/S filter, 3/omega, and one of its samples; of a unicycle its lag [s]."""
    llc = f"{car}llc"
    if llc not in configuration:
        return configuration.number(f"{car}plant", f"{what}.lag")
    return 3.0 / configuration.number(llc, f"filter.{what}") + configuration.number(llc, "sample_period")
