"""An obstacle appears ahead of the car, which brakes, steers, does both, or makes the best of it."""

from cosim.scenario import Scenario
from scenarios.collision_avoidance import loop as _avoidance
from scenarios.collision_avoidance.metrics import avoidance_metrics
from scenarios.shared.catalogue import fmu_path

SCENARIO = Scenario(
    name="collision-avoidance",
    title="An obstacle appears ahead: the car decides by its last points to brake and to steer, plans, and evades",
    figures="section 3.3.7 (collision avoidance system)",
    stop_time=5.0,
    build=_avoidance.loop,
    complete=_avoidance.complete,
    find=fmu_path,
    metrics=avoidance_metrics,
    draw=_avoidance.draw,
    settings=_avoidance.SETTINGS,
)
