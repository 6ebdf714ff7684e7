"""Four cars in a V, then in a line, whose followers learn the motion of their leader with a neural network.

In a V everybody keeps to a car diagonally ahead, never far away: the further behind a place is, the faster a bend of
the leader moves it sideways, and that has to be learnt first. Once the head drives straight on, at 30 s, all move into
one line.

A constant acceleration a of the leader leaves an error of about 7 a / (3.5 K^2), so the gain K is higher than by its
start value. At 30 m/s the sideslip takes all that turning gives a hand point 6 m ahead, in the steady state; 8 m ahead
it is damped better.
"""

from scenarios.formation.law import Law, adaptive_gains
from scenarios.formation.work import formation_work, weaving

_LAW = Law("AdaptiveFollower", motion=False, parameters={**adaptive_gains(3.0), "hand.distance": 8.0})
WORK = formation_work(_LAW, weaving(5.0), shapes=[(30.0, "line")])
