"""A car planned along a road while it drives."""

from cosim.scenario import NumberSetting, Scenario
from scenarios.arbitrary_path import loop as _arbitrary_path
from scenarios.arbitrary_path.metrics import arbitrary_path_metrics
from scenarios.shared.catalogue import fmu_path

SCENARIO = Scenario(
    name="arbitrary-path",
    title="A road driven in time-suboptimal motion, planned on a receding horizon while driving",
    figures="Figs. 3.16 to 3.18 in part: path, speeds and commands of one drive",
    stop_time=36.0,
    build=_arbitrary_path.loop,
    complete=_arbitrary_path.start_beside_plan,
    find=fmu_path,
    metrics=arbitrary_path_metrics,
    draw=_arbitrary_path.draw,
    settings={
        "lateral_offset": NumberSetting(0.0, -1.0, 1.0, "m", "start to the left of the plan"),
        "margin": NumberSetting(0.1, 0.0, 1.0, "m", "distance the plan keeps from both edges, beyond the clearance"),
    },
)
