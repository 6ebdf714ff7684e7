"""Four cars in a diamond, then in a line, then in a wedge; constraint forces hold the followers in their places.

All three followers see the head throughout: only their places change, at 15 and 30 s, while the head weaves.
"""

from scenarios.formation.scenario import formation_scenario, weaving
from scenarios.formation.system import Cars, Law

_FIRM = {"omega_n": 2.0, "hand.distance": 4.0}
"""In a line the last car is 30 m behind the head, and any bend of the head moves its place sideways; the follower
learns of that by radio. At 2 rad/s it makes good within two seconds what it could not foresee. In a bend O1 lags behind
the hand point, which is what is controlled, in proportion to their distance; the delays of the car being made up for,
4 m are enough."""

SCENARIO = formation_scenario(
    "formation-constraint",
    "Followers held by constraint forces, from diamond to line to left wedge, 20 to 30 m/s",
    "Figs. 5.4, 5.5",
    40.0,
    law=Law("ConstraintFollower", motion=True, parameters=_FIRM),
    cars=Cars(reference=weaving(8.0)),
    kind="diamond",
    shapes=((15.0, "line"), (30.0, "left-wedge")),
)
