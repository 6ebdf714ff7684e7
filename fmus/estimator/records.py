"""What the filter keeps of a sample and of a fix, and what it assumes: the layouts its modules share."""

from __future__ import annotations

from fmukit.kernel import Layout
from fmus.estimator.navigation import PACKED, PROCESS, UNIT

SENSED = Layout(unit=UNIT, tilt=2, speed=1)
"""Of a sample: the inertial unit, roll and pitch by the suspension [rad], speed of the rear wheels [m/s]."""
PLACE = Layout(position=2, position_variance=1, heading=1, heading_variance=1, place_delay=1)
"""Of a fix: position and heading; a variance of 0: there is none. `place_delay`: end of its row less instant [s]."""
DRIFT = Layout(velocity=2, velocity_variance=1, alone=1, drift_delay=1)
"""Of a fix: velocity, likewise; `alone` is 1 where it comes without a heading."""
ROW = Layout(sensed=SENSED, place=PLACE, drift=DRIFT, doubt=1)
"""A sample and the parts of fixes that belong to it; `doubt` is 1 where a fix is to be taken as it is."""

GATES = Layout(heading=1, position=1, velocity=1)
"""Largest normalised innovations squared."""
COURSE = Layout(used=1, sideslip=1, rate=1, force=1, speed=1)
"""1 if the course tells the heading; variance of the sideslip in straight motion [rad2], and what that is: largest yaw
rate [rad/s] and lateral acceleration [m/s2], least speed [m/s]."""
ROLLING = Layout(used=1, speed=1, sideslip=1, slope=1, floor=1, compliance=1)
"""1 if wheels are used; variances of a reading: relative speed, sideslip [rad2], the same per lateral acceleration
squared, velocity at rest [m2/s2]; sideslip of the rear axle per lateral acceleration [rad/(m/s2)]."""
ARMS = Layout(antenna=3, rear=3)
"""From the inertial unit to the main antenna and to the middle of the rear axle, body frame [m]."""
ASSUMED = Layout(
    period=1, process=PROCESS, tilt=1, gates=GATES, course=COURSE, rolling=ROLLING, arms=ARMS, initial=PACKED
)
"""Sampling period [s], process noise, variance of a reading of roll or pitch [rad2], and the initial covariance."""
VERDICT = Layout(nis=3, accepted=3)
"""Of the newest heading, position and velocity: NIS, and 1 where it was accepted."""
TALLY = Layout(used=1, refused=1, in_a_row=1, doubted=1)
"""Fixes used in full, refused wholly or in part, and refused since the last one used in full."""
