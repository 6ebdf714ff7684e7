"""The time-optimal double lane change of the planar car, started beside the plan."""

from cosim.scenario import Scenario
from scenarios.lane_change import loop
from scenarios.lane_change.metrics import lane_change_metrics
from scenarios.shared.catalogue import fmu_path

SCENARIO = Scenario(
    name="double-lane-change",
    title="Time-optimal double lane change of a planar car with four driven wheels, started 0.3 m beside the plan",
    figures="Figs. 3.11 to 3.13, of Fig. 3.14 the MPC signals (concept of Fig. 3.3, path of Fig. 3.4)",
    stop_time=7.5,
    build=loop.planar_loop,
    complete=loop.start_beside_plan,
    find=fmu_path,
    metrics=lane_change_metrics,
    draw=loop.draw,
    settings=loop.perturbations(lateral=0.3),
)
