"""A car whose way along a road is planned while it drives."""

from cosim.scenario.definition import Scenario
from cosim.scenario.settings import NumberSetting

ARBITRARY_PATH = Scenario(
    name="arbitrary-path",
    title="A road driven in time-suboptimal motion, planned on a receding horizon while driving",
    figures="Figs. 3.16 to 3.18 in part: path, speeds and commands of one drive",
    stop_time=36.0,
    module="scenarios.arbitrary_path.loop",
    settings={
        "lateral_offset": NumberSetting(0.0, -1.0, 1.0, "m", "start to the left of the plan"),
        "margin": NumberSetting(0.1, 0.0, 1.0, "m", "distance the plan keeps from both edges, beyond the clearance"),
    },
)
