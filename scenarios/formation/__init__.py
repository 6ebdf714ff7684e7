"""Cars in formation: a head that tracks a trajectory, and followers that keep their places."""

from cosim.scenario.definition import Scenario
from scenarios.formation.settings import RECORD_EVERY, UNRECORDED, formation_settings

_SPACING = 10.0  # m; 5.3 m from bumper to bumper

ADAPTIVE = Scenario(
    name="formation-adaptive",
    title="Adaptive neural followers of a weaving head that speeds up from 20 to 30 m/s, from V to line",
    figures="Figs. 5.2, 5.3",
    stop_time=42.0,
    module="scenarios.formation.adaptive",
    settings=formation_settings(4, "v", _SPACING),
    record_every=RECORD_EVERY,
    unrecorded=UNRECORDED,
)
CONSTRAINT = Scenario(
    name="formation-constraint",
    title="Followers held by constraint forces, from diamond to line to left wedge, 20 to 30 m/s",
    figures="Figs. 5.4, 5.5",
    stop_time=40.0,
    module="scenarios.formation.constraint",
    settings=formation_settings(4, "diamond", _SPACING),
    record_every=RECORD_EVERY,
    unrecorded=UNRECORDED,
)
