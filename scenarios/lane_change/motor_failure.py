"""The time-optimal double lane change, in which a motor is lost half-way."""

from cosim.model.system import System
from cosim.scenario import NumberSetting, Scenario, Setting, Settings
from scenarios.lane_change import loop
from scenarios.lane_change.metrics import motor_failure_metrics
from scenarios.shared.catalogue import fmu_path

_MARGIN = 0.1
"""Distance [m] by which the plan keeps off the edges of the corridor, for the feedback to use."""


def _build(settings: Settings) -> System:
    system = loop.planar_loop(settings, _MARGIN)
    system.at(settings["failure_time"], f"mpc.motor_available.{settings['motor']}", 0.0)
    return system


SCENARIO = Scenario(
    name="motor-failure",
    title="Double lane change of the planar car that loses one of its four motors half-way",
    figures="the path of Fig. 3.4 with the distribution of Figs. 3.11 and 3.12 after the loss of a motor",
    stop_time=7.6,
    build=_build,
    complete=loop.start_beside_plan,
    find=fmu_path,
    metrics=motor_failure_metrics,
    draw=loop.draw,
    settings={
        "motor": Setting("rr", ("fl", "fr", "rl", "rr"), "the wheel whose motor is lost"),
        "failure_time": NumberSetting(4.0, 0.0, 7.0, "s", "when it is lost"),
        **loop.perturbations(),
    },
)
