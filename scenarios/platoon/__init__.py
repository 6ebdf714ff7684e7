"""Cars in a row: whether disturbances grow from car to car.

A push, the head brakes and accelerates, a car moves in; or the head excites all frequencies that matter.
"""

from cosim.scenario.definition import Scenario
from scenarios.formation.settings import RECORD_EVERY, UNRECORDED
from scenarios.platoon.events import END
from scenarios.platoon.settings import SETTINGS

PLATOON = Scenario(
    name="platoon",
    title="Cars in a row: one is pushed, the first one brakes, one moves in; do disturbances grow from car to car?",
    figures="chapter 5 (no figure)",
    stop_time=END,
    module="scenarios.platoon.work",
    settings=SETTINGS,
    record_every=RECORD_EVERY,
    unrecorded=UNRECORDED,
)
