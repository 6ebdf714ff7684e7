"""Cars in a V, then in a line, whose followers hear how their leader moves and learn the rest with a neural network.

Once the head drives straight on, at 30 s, all move into one line.

A constant acceleration a that the network has to learn leaves an error of about 7 a / (3.5 K^2), so the gain K is
higher than by its start value. At 30 m/s the sideslip takes all that turning gives a hand point 6 m ahead, in the
steady state; 8 m ahead it is damped better. The memory of the leader's filter is longer than that of constraint
followers: here the noise of messages goes into a speed, which is differentiated, and not into an acceleration. With
rates a lost message is carried further before the leader counts as lost.
"""

from scenarios.formation.law import Law, adaptive_gains
from scenarios.formation.work import formation_work, weaving

_HEARD = {"heard_rates": True, "leader.filter_time": 0.3, "link.patience": 1.0}
_LAW = Law("AdaptiveFollower", parameters={**adaptive_gains(3.0), "hand.distance": 8.0, **_HEARD})
WORK = formation_work(_LAW, weaving(5.0), shapes=[(30.0, "line")])
