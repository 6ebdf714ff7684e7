"""Four cars in a diamond, then in a line, then in a wedge; constraint forces hold the followers in their places.

All three followers see the head throughout: only their places change, at 15 and 30 s, while the head weaves.

In a line the last car is 30 m behind the head, and any bend of the head moves its place sideways; the follower learns
of that by radio. At 2 rad/s it makes good within two seconds what it could not foresee. In a bend O1 lags behind the
hand point, which is what is controlled, in proportion to their distance; the delays of the car being made up for, 4 m
are enough.
"""

from scenarios.formation.law import Law
from scenarios.formation.work import formation_work, weaving

_LAW = Law("ConstraintFollower", motion=True, parameters={"omega_n": 2.0, "hand.distance": 4.0})
WORK = formation_work(_LAW, weaving(8.0), shapes=[(15.0, "line"), (30.0, "left-wedge")])
