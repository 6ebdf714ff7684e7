"""What is said at the start of a formation whose errors will grow from car to car, with the factor theory gives."""

from __future__ import annotations

import logging
from collections.abc import Mapping

from cosim.model.configuration import Configuration
from fmus.controllers.adaptive_follower.network import N2
from scenarios.formation.growth import AdaptiveLink, ConstraintLink, across, along
from scenarios.formation.timetable import Formation
from scenarios.formation.topology import HEAD, prefix
from scenarios.shared.start import first_point

_NOTHING = 1.05
"""A factor per link up to which nothing is said."""
_LOG = logging.getLogger("cosim")


def advise(configuration: Configuration, formation: Formation, remedies: str) -> None:
    """Warn where motions grow by more than 5 % per link along two links or more, and what the `remedies` are."""
    links = longest_chain(formation.leaders)
    if links < 2:
        return
    speed = first_point(configuration, prefix(HEAD)).speed
    factor, why = max(growth(configuration, car, formation.trailing, speed) for car in formation.leaders)
    if factor > _NOTHING:
        _LOG.warning(
            "along %d links errors are expected to grow by a factor of up to %.2f per link, since %s; %s",
            *(links, factor, why, remedies),
        )


def longest_chain(leaders: Mapping[int, int]) -> int:
    """How many links lie between the head and the car that is furthest from it."""
    depth = {HEAD: 0}
    for car, leader in leaders.items():
        depth[car] = depth[leader] + 1
    return max(depth.values())


def growth(configuration: Configuration, car: int, trailing: bool, speed: float) -> tuple[float, str]:
    """The largest factor of the link to `car`, across or along the road, and what makes it."""
    follower = f"{prefix(car)}follower"
    number = configuration.number
    hand, behind = number(follower, "hand.distance"), -number(follower, "formation.x")
    behind += number(follower, "headway") * speed
    lever = 1.0 if trailing else across(behind, hand)
    road = along(link_of(configuration, car))
    if lever > road:
        return lever, f"a place {behind:.3g} m behind a hand of {hand:.3g} m swings with the leader"
    return road, "what each follower knows of the car ahead is filtered and its own car lags"


def link_of(configuration: Configuration, car: int) -> AdaptiveLink | ConstraintLink:
    """The link to `car` as its follower and its plant are set."""
    follower, number = f"{prefix(car)}follower", configuration.number
    common = {
        "lag": lag_of(configuration, car),
        "memory": number(follower, "leader.filter_time"),
        "headway": number(follower, "headway"),
    }
    if configuration.model(follower) == "AdaptiveFollower":
        return AdaptiveLink(
            **common,
            gain=number(follower, "gain"),
            integral=number(follower, "adaptation.output") * (1 + N2 / 4),
            reference_time=number(follower, "realise.speed_time"),
            lead=number(follower, "lead.speed"),
            heard=bool(number(follower, "heard_rates")),
        )
    return ConstraintLink(
        **common,
        omega_n=number(follower, "omega_n"),
        zeta=number(follower, "zeta"),
        headway_filter=number(follower, "headway.filter"),
        told=bool(number(follower, "feedforward.enabled")),
    )


def lag_of(configuration: Configuration, car: int) -> float:
    """By which the speed answers late [s]: the lag of a unicycle, or the D/S filter, 3/omega, of the low level."""
    llc = f"{prefix(car)}llc"
    if llc in configuration:
        return 3.0 / configuration.number(llc, "filter.speed")
    return configuration.number(f"{prefix(car)}plant", "speed.lag")
