"""An obstacle appears ahead of the car, which brakes, steers, does both, or makes the best of it."""

from cosim.scenario.definition import Scenario
from cosim.scenario.settings import NumberSetting

COLLISION_AVOIDANCE = Scenario(
    name="collision-avoidance",
    title="An obstacle appears ahead: the car decides by its last points to brake and to steer, plans, and evades",
    figures="section 3.3.7 (collision avoidance system)",
    stop_time=5.0,
    module="scenarios.collision_avoidance.loop",
    settings={
        "speed": NumberSetting(25.0, 15.0, 35.0, "m/s", "speed when the obstacle appears"),
        "distance": NumberSetting(40.0, 0.1, 300.0, "m", "from the front bumper to the obstacle when it appears"),
        "friction": NumberSetting(1.0, 0.3, 1.0, "1", "friction of the road, which the car knows"),
        "width": NumberSetting(2.0, 0.1, 7.0, "m", "width of the obstacle in the middle of the car's lane"),
    },
)
