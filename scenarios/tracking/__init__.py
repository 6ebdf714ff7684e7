"""A car that follows a trajectory by the controllers of chapter 4."""

from cosim.scenario.definition import Scenario
from scenarios.shared.settings import SENSORS

HIGH_SPEED = Scenario(
    name="high-speed-tracking",
    title="Overlapping acceleration, evasive weave and braking, 25 to 33 m/s, whole control system in the loop",
    figures="Fig. 4.10 (architecture of Fig. 4.9)",
    stop_time=16.0,
    module="scenarios.tracking.high_speed",
    settings=SENSORS,
)
LONGITUDINAL = Scenario(
    name="longitudinal-tracking",
    title="Accelerating and braking on a straight line, 15 to 30 m/s and back at 3 m/s2",
    figures="Figs. 4.5, 4.6 and 4.8, left",
    stop_time=17.0,
    module="scenarios.tracking.longitudinal",
    settings=SENSORS,
)
LATERAL = Scenario(
    name="lateral-tracking",
    title="Evasive weave at a constant 30 m/s",
    figures="Figs. 4.5, 4.6 and 4.8, right",
    stop_time=16.0,
    module="scenarios.tracking.lateral",
    settings=SENSORS,
)
