"""The time-optimal double lane change of the multibody car, planned for that car."""

from cosim.model.system import System
from cosim.scenario import Scenario, Settings
from scenarios.lane_change import loop
from scenarios.lane_change.metrics import multibody_metrics
from scenarios.shared.catalogue import fmu_path
from scenarios.shared.sensors import SETTINGS, TRUE_RATES, TRUE_YAW_RATE, add_sensors, feed_back

_SERVOS = 0.02
"""Time constant [s] the controller assumes of the steering servos, behind the filter of their demand."""
_CALM = {"weight.steer_change": 1000.0, "integral.gain": 0.1}
"""Of the controller: the noise of the estimate reaches the steering three times less than by its start values."""


def _build(settings: Settings) -> System:
    from fmus.cars.derived import double_track_values  # noqa: PLC0415  (lazy: `cosim list`)
    from fmus.cars.nominal import DESIGN  # noqa: PLC0415
    from fmus.planner.planned_cars import multibody  # noqa: PLC0415

    system = System()
    system.add("plant", "Vehicle16Dof", {"body_force.y": settings["side_force"]})
    add_sensors(system, settings)
    plan = loop.lane_change_plan(multibody(DESIGN).vehicle)
    system.add("reference", "ReferenceTrajectory", {"trajectory_file": str(plan)})
    assumed = {f"design.{name}": value for name, value in double_track_values(DESIGN).items()}
    system.add("mpc", "MpcAllocator", assumed | _CALM)
    system.add("llc", "LowLevelPid", {"speed.fed_through": True, "yaw.fed_through": True})
    system.connect("reference", "mpc")
    system.connect(
        "mpc", "llc", {"command.wheel_torque.": "wheel_torque.", "command.steer_angle": "command.steer_angle"}
    )
    system.connect("plant", "llc")
    system.connect("llc", "plant")
    feed_back(system, settings, "mpc", TRUE_YAW_RATE)
    feed_back(system, settings, "llc", TRUE_RATES)
    return system


def _complete(system: System, settings: Settings) -> None:
    loop.start_beside_plan(system, settings)
    _tell_the_actuator(system)


def _tell_the_actuator(system: System) -> None:
    """What mpc assumes of the steering are the limits of llc, unless it was told otherwise."""
    from fmus.controllers.low_level_pid.interface import INTERFACE  # noqa: PLC0415

    starts = {variable.name: variable.start for variable in INTERFACE.select("parameter")}
    assumed, given = system.instances["mpc"].parameters, system.instances["llc"].parameters
    for ours, theirs in (("steer_rate", "steering.rate_limit"), ("steer_limit", "steering.angle_limit")):
        assumed.setdefault(f"actuator.{ours}", given.get(theirs, starts[theirs]))
    filter_time = float(given.get("steering.filter_time", starts["steering.filter_time"]))
    assumed.setdefault("actuator.steer_lag", filter_time + _SERVOS)


SCENARIO = Scenario(
    name="double-lane-change-16dof",
    title="Time-optimal double lane change of the multibody car, planned for it, steering servos and active suspension",
    figures="those of double-lane-change, on the car of chapter 4",
    stop_time=8.0,
    build=_build,
    complete=_complete,
    find=fmu_path,
    metrics=multibody_metrics,
    draw=loop.draw,
    settings={**SETTINGS, **loop.perturbations()},
)
