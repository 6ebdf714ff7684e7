"""What AdaptiveFollower shows."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import Advice, group, load_parameters, output, sampled
from fmus.controllers.formation import bus

_TOO_FAST = (
    "adaptation.output (F) = {adaptation.output} is too large for gain (K) = {gain}: the adaptation then swings; "
    "choose F <= K^2/7 (K^2/(2 (1 + N2/4)) with N2 = 10 neurons), for instance a larger gain"
)

INTERFACE = sampled(
    "AdaptiveFollower",
    "Formation keeping without knowing the leader's velocity, which a neural network learns while driving",
    step=0.020,
    variables=[
        *load_parameters(Path(__file__).with_name("parameters.toml")),
        *bus.follower_parameters(),
        *bus.follower_inputs(),
        *bus.follower_outputs(led_back=True),
        output("weights.norm", "m/s", "size of the output weights, the Frobenius norm of W"),
        output("weights.hidden_norm", "1", "size of the hidden weights, the Frobenius norm of V"),
        *group(output, "velocity", "xy", "m/s", "velocity of the wanted place in the leader's body axes, as learnt"),
        output("gain_rule.broken", "1", "1 while adaptation.output is too large for gain, else 0"),
    ],
    advice=[Advice("gain_rule.broken", _TOO_FAST)],
)
