"""Cars in a diamond, then in a line, then in a wedge; constraint forces hold the followers in their places.

All followers see the head throughout: only their places change, at 15 and 30 s, while the head weaves. What the head
does they learn by radio; at 2 rad/s a follower makes good within two seconds what it could not foresee. In a bend O1
lags behind the hand point, which is what is controlled, in proportion to their distance; the delays of the car being
made up for, 4 m are enough.
"""

from scenarios.formation.law import Law
from scenarios.formation.work import formation_work, weaving

_LAW = Law("ConstraintFollower", parameters={"omega_n": 2.0, "hand.distance": 4.0})
WORK = formation_work(_LAW, weaving(8.0), shapes=[(15.0, "line"), (30.0, "left-wedge")])
