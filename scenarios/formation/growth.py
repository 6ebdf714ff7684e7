"""By how much a motion grows from a car to the one that follows it, on paper: sup |Gamma(j omega)| of one link.

Across the road a place at d = -r_x behind the leader's hand swings with the leader's yaw angle, and the follower's own
hand, a ahead of O1, is where that swinging is passed on. At the speed v

    P(s) = (v + (a - d) s)/(v + a s),   sup |P| = (d - a)/a where d > 2 a, else 1

Along the road, with the lag tau of the speed, headway h and what a filter of memory T_f makes of the leader's
acceleration, F = (1 + 3 T_f s)/(1 + T_f s)^3:

    adaptive    Gamma = (D s + C)/(s (1 + tau s)(1 + (tau_r + h) s) + C (1 + h s (1 + tau s))),   C = K + K_i/s
                D = 1 + (tau_r + tau_l) F s where rates are heard, 0 where they are learnt
    constraint  Gamma = (F s^2 + K_d s + K_p)/(s^2 (1 + tau s) + K_d s + K_p) / (1 + h s w^2/(s + w)^2)
                without F s^2 where the head's acceleration stands in for the leader's

with tau_r = `realise.speed_time`, tau_l = `lead.speed`, w = `headway.filter`. Messages are taken to be always there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosim.model.signals import Vector

_OMEGA = np.logspace(-2, 1.5, 1000)
"""Frequencies [rad/s] that are looked at; above, cars hardly move."""


@dataclass(frozen=True, slots=True)
class Link:
    """What both laws have: the lag of the speed, the memory of the leader's filter and the headway [s]."""

    lag: float
    memory: float
    headway: float


@dataclass(frozen=True, slots=True)
class AdaptiveLink(Link):
    """K [1/s], K_i [1/s2], tau_r and tau_l [s], and whether the leader's rates are heard."""

    gain: float
    integral: float
    reference_time: float
    lead: float
    heard: bool


@dataclass(frozen=True, slots=True)
class ConstraintLink(Link):
    """omega_n [rad/s], zeta, the bandwidth w [rad/s] of the headway, and whether the head's speed is told to all."""

    omega_n: float
    zeta: float
    headway_filter: float
    told: bool = False


def across(behind: float, hand: float) -> float:
    """sup |P| of a place `behind` [m] the leader's hand, in its body axes, for a `hand` [m] ahead of O1."""
    return max(1.0, (behind - hand) / hand)


def along(link: AdaptiveLink | ConstraintLink) -> float:
    """sup |Gamma| along the road."""
    return float(np.abs(transfer(link, _OMEGA)).max())


def transfer(link: AdaptiveLink | ConstraintLink, omega: Vector) -> np.ndarray:
    """Gamma (n,) at the frequencies omega (n,) [rad/s]."""
    s = 1j * omega
    filtered = (1 + 3 * link.memory * s) / (1 + link.memory * s) ** 3
    return _adaptive(link, s, filtered) if isinstance(link, AdaptiveLink) else _constraint(link, s, filtered)


def _adaptive(link: AdaptiveLink, s: np.ndarray, filtered: np.ndarray) -> np.ndarray:
    law, car, h = link.gain + link.integral / s, 1 + link.lag * s, link.headway
    heard = (1 + (link.reference_time + link.lead) * filtered * s) * link.heard
    reference = 1 + (link.reference_time + h) * s
    return np.asarray((heard * s + law) / (s * car * reference + law * (1 + h * s * car)))


def _constraint(link: ConstraintLink, s: np.ndarray, filtered: np.ndarray) -> np.ndarray:
    law = 2 * link.zeta * link.omega_n * s + link.omega_n**2
    back = 1 + link.headway * s * (link.headway_filter / (s + link.headway_filter)) ** 2
    own = filtered * s**2 * (not link.told)
    return np.asarray((own + law) / (s**2 * (1 + link.lag * s) + law) / back)
