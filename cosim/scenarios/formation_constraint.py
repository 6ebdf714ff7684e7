"""Four cars in a diamond, then in a line, then in a wedge; constraint forces hold the followers in their places."""

from cosim.scenarios._formation import Cars, Law
from cosim.scenarios._formation_scenario import formation_scenario, weaving

SCENARIO = formation_scenario(
    "formation-constraint",
    "Followers held by constraint forces, from diamond to line to left wedge, 20 to 30 m/s",
    "Figs. 5.4, 5.5",
    40.0,
    law=Law("ConstraintFollower", motion=True, parameters={"omega_n": 1.5}),
    cars=Cars(reference=weaving(8.0)),
    kind="diamond",
    shapes=((15.0, "line"), (30.0, "left-wedge")),
)
