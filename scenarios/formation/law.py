"""How a follower keeps its place. Light to import."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cosim.model.face import Value


@dataclass(frozen=True, slots=True)
class Law:
    """The `model` of a follower, and values of its parameters beyond those of the settings.

    `told` are parameters
    where the head broadcasts its speed; they take the place of those in `parameters`.
    """

    model: str
    parameters: Mapping[str, Value] = field(default_factory=dict)
    told: Mapping[str, Value] = field(default_factory=dict)


def adaptive_gains(gain: float) -> dict[str, float]:
    """The gain K [1/s] of an AdaptiveFollower and the rates of its network, by the rule F = K^2/7, G = F/2."""
    return {"gain": gain, "adaptation.output": gain**2 / 7.0, "adaptation.hidden": gain**2 / 14.0}
