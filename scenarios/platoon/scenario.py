"""Ten cars in a row: a push, the head brakes and accelerates, a car moves in; or the head excites all frequencies."""

from cosim.scenario import Scenario
from scenarios.formation.scenario import UNRECORDED, draw
from scenarios.platoon import system as _platoon
from scenarios.platoon.metrics import platoon_metrics
from scenarios.shared.catalogue import fmu_path

SCENARIO = Scenario(
    name="platoon",
    title="Cars in a row: one is pushed, the first one brakes, one moves in; do disturbances grow from car to car?",
    figures="chapter 5 (no figure)",
    stop_time=_platoon.END,
    build=_platoon.system,
    complete=_platoon.complete,
    find=fmu_path,
    metrics=platoon_metrics,
    draw=draw,
    record_every=0.02,
    unrecorded=UNRECORDED,
    settings=_platoon.SETTINGS,
)
