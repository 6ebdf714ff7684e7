"""The laws by which cars of a platoon keep their places, and the headway that they need. Light to import.

With a time headway h the wanted place of a follower moves back by h times its own speed. In a chain that widens every
gap, in a star it moves all followers back alike.

`HEADWAY` is the one at which nothing grows. Along the road, the motion of a follower is that of its leader times Gamma,

    1/Gamma = 1 + h s (1 + tau s) + s^2 (1 + tau s)(1 + (tau_r + h) s)/(K s + K_i)

with the lag tau of the speed behind its command, tau_r = `realise.speed_time` and the rate K_i at which the network's
bias integrates; at low frequency |1/Gamma|^2 = 1 + omega^2 (h^2 - 2 h tau - 2/K_i), so h >= tau + sqrt(tau^2 + 2/K_i).
"""

from __future__ import annotations

from dataclasses import replace

from cosim.scenario.settings import Settings
from scenarios.formation.law import Law, adaptive_gains

HEADWAY = 1.0
"""[s]; with K = 3/s and K_i = 5/s2 a lag of the speed of 0.1 s needs 0.78 s, one of 0.2 s 0.92 s."""
GAIN = 3.0
"""K of adaptive followers: firmer than its start value, which halves errors and headway."""
_TOLD = {"gain": 2.0, "adaptation.output": 0.01, "adaptation.hidden": 0.005}
"""The same while they are told the head's speed, which makes errors small but not their ratio: that is T of the law, so
it takes a network that learns slowly and a gain that the lags leave well damped."""
_BACK = {"headway.filter": 5.0}
"""Of constraint followers: with the slower filter they start with, they pass on fast motions as without headway."""
_HEARD = {"heard_rates": True, "link.patience": 1.0}
"""Of adaptive followers that keep a headway, or see the head: with neither, a speed passed on from car to car grows
faster than one that is learnt (`scenarios.formation.growth`: 3.0 instead of 2.0). With rates a lost message is carried
further."""
_SHORTEST_MEMORY, _LONGEST_MEMORY = 0.3, 0.5
"""Of the filter of the leader's rates [s]: half the headway, within these. What a long one smooths of late and lost
messages it delays of the leader's braking; the more headway, the less that is passed on."""
_APART = 0.2
"""Headway [s] from which on rates that are heard grow less than those that are learnt."""
LED = {"AdaptiveFollower": ("speed",), "ConstraintFollower": ("yaw_rate",)}
"""By model of the follower: the delays of its car it makes up for. On a straight a lead of the yaw rate of adaptive
followers would pass on more of that than it takes."""
_DURATION = {"formation.duration": 12.0}  # s; a gap of one headway opens so slowly that nobody brakes hard
LAWS = {
    "adaptive": Law("AdaptiveFollower", parameters={**_DURATION, **adaptive_gains(GAIN)}, told=_TOLD),
    "constraint": Law("ConstraintFollower", parameters={**_DURATION, **_BACK}),
}
"""By the name they have in the setting."""


def law_of(settings: Settings) -> Law:
    """The law that the settings name, with what its followers use of what they hear."""
    law = LAWS[settings["law"]]
    apart = settings["topology"] == "star" or settings["headway"] >= _APART
    if law.model != "AdaptiveFollower" or not apart:
        return law
    memory = min(max(_SHORTEST_MEMORY, 0.5 * settings["headway"]), _LONGEST_MEMORY)
    return replace(law, parameters={**law.parameters, **_HEARD, "leader.filter_time": memory})
