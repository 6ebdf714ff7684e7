"""Four cars in a diamond, whose followers estimate the motion of their leader with a neural network."""

from cosim.scenarios._formation import Cars, Law
from cosim.scenarios._formation_scenario import formation_scenario, weaving

SCENARIO = formation_scenario(
    "formation-adaptive",
    "Adaptive neural followers of a weaving head that speeds up from 20 to 30 m/s",
    "Figs. 5.2, 5.3",
    30.0,
    law=Law("AdaptiveFollower", motion=False),
    cars=Cars(reference=weaving(5.0)),
    kind="diamond",
)
