"""Four cars in a V, then in a line, whose followers learn the motion of their leader with a neural network.

In a V everybody keeps to a car diagonally ahead, never far away: the further behind a place is, the faster a bend of
the leader moves it sideways, and that has to be learnt first. Once the head drives straight on, at 30 s, all move into
one line.
"""

from scenarios.formation.scenario import formation_scenario, weaving
from scenarios.formation.system import Cars, Law

_GAIN = 3.0
_FIRM = {
    "gain": _GAIN,
    "adaptation.output": _GAIN**2 / 7.0,
    "adaptation.hidden": _GAIN**2 / 14.0,
    "hand.distance": 8.0,
}
"""A constant acceleration a of the leader leaves an error of about 7 a / (3.5 K^2), so the gain K is higher than by its
start value; the rates of the network follow from it by the rule F = K^2/7, G = F/2. At 30 m/s the sideslip takes all
that turning gives a hand point 6 m ahead, in the steady state; 8 m ahead it is damped better."""

SCENARIO = formation_scenario(
    "formation-adaptive",
    "Adaptive neural followers of a weaving head that speeds up from 20 to 30 m/s, from V to line",
    "Figs. 5.2, 5.3",
    42.0,
    law=Law("AdaptiveFollower", motion=False, parameters=_FIRM),
    cars=Cars(reference=weaving(5.0)),
    kind="v",
    shapes=((30.0, "line"),),
)
