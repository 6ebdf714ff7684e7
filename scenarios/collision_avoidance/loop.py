"""An obstacle appears ahead: what the car decides, the manoeuvre it plans, and the loop that drives it.

The decision and the plan are those of fmus/planner/evasion; ReferenceTrajectory plays the plan, MpcAllocator tracks it.
"""

from __future__ import annotations

import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from cosim.errors import CosimError
from cosim.model.face import Value
from cosim.model.system import System
from cosim.results.reading import Results
from cosim.scenario import NumberSetting, Settings
from scenarios.shared.plans import kept
from scenarios.shared.sensors import TRUE_STATES
from scenarios.shared.start import start_on_reference

if TYPE_CHECKING:
    from fmus.planner.evasion.decision import Decision
    from fmus.planner.evasion.situation import Encounter

SETTINGS = {
    "speed": NumberSetting(25.0, 15.0, 35.0, "m/s", "speed when the obstacle appears"),
    "distance": NumberSetting(40.0, 0.1, 300.0, "m", "from the front bumper to the obstacle when it appears"),
    "friction": NumberSetting(1.0, 0.3, 1.0, "1", "friction of the road, which the car knows"),
    "width": NumberSetting(2.0, 0.1, 7.0, "m", "width of the obstacle in the middle of the car's lane"),
}
_USED = 0.85
"""Part of the friction within which the wheel forces stay; MpcAllocator does not know that a longitudinal force takes
from the lateral one (engineering choice, enough for 8 m/s2)."""
_WHEELS = ("fl", "fr", "rl", "rr")


def encounter(settings: Settings) -> Encounter:
    """What the settings describe."""
    from fmus.planner.evasion.situation import Encounter  # noqa: PLC0415  (lazy: `cosim list`)

    return Encounter(**{name: settings[name] for name in SETTINGS})


def decision(settings: Settings) -> Decision:
    """What the car decides to do; raises CosimError for an encounter that cannot be."""
    from fmus.planner.errors import PlanningError  # noqa: PLC0415
    from fmus.planner.evasion import decision, table  # noqa: PLC0415

    try:
        return decision.decide(encounter(settings), table.read())
    except PlanningError as error:
        raise CosimError(str(error)) from error


def trajectory_file(settings: Settings) -> Path:
    """The planned manoeuvre, from the cache if it was planned before."""
    from fmus.planner import trajectory  # noqa: PLC0415
    from fmus.planner.errors import PlanningError  # noqa: PLC0415
    from fmus.planner.evasion import manoeuvre, table  # noqa: PLC0415

    met = encounter(settings)

    def make(file: Path) -> None:
        trajectory.write_rows(manoeuvre.manoeuvre(met).rows, file)

    try:
        return kept("collision-avoidance", [repr(asdict(met)), table.FILE.read_bytes()], make)
    except PlanningError as error:
        raise CosimError(str(error)) from error


def loop(settings: Settings) -> System:
    """DoubleTrack with combined slip under MpcAllocator, which sees the true states and knows the friction.

    The wheel torques stand for motors and brakes together: there is no limit of power, and the wheels lock before a
    brake has given all it can.
    """
    mu = settings["friction"]
    system = System()
    system.add("plant", "DoubleTrack", {"tyre.combined_slip": True, **{f"road_friction.{w}": mu for w in _WHEELS}})
    system.add("reference", "ReferenceTrajectory", {"trajectory_file": str(trajectory_file(settings))})
    system.add(
        "mpc", "MpcAllocator", {"limit.force": 5000.0, "limit.power": 1e6, "limit.friction": _USED * mu, **_tyres(mu)}
    )
    system.connect("reference", "mpc")
    system.connect("plant", "mpc", TRUE_STATES)
    system.connect("mpc", "plant")
    return system


def complete(system: System, settings: Settings) -> None:
    """Start on the plan; raises CosimError where values of instances contradict what was decided for."""
    plant, reference = (system.instances[name].parameters for name in ("plant", "reference"))
    if reference["trajectory_file"] != str(trajectory_file(settings)):
        raise CosimError("reference.trajectory_file is what the scenario plans; set scenario.* instead")
    start_on_reference(system)
    decided: dict[str, float] = {f"road_friction.{w}": settings["friction"] for w in _WHEELS}
    decided |= {"initial.speed": settings["speed"], "initial.position.x": 0.0}
    for name, value in decided.items():
        if not _equal(plant[name], value):
            setting = {"initial.speed": "speed", "initial.position.x": "distance"}.get(name, "friction")
            raise CosimError(
                f"plant.{name} = {plant[name]} is not what the car decides and plans for ({value:g}); "
                f"set scenario.{setting} instead"
            )


def _equal(given: Value, value: float) -> bool:
    """Whether they are the same number; the plan keeps nine digits."""
    try:
        return math.isclose(float(given), value, rel_tol=1e-8, abs_tol=1e-8)
    except ValueError:
        return False


def _tyres(mu: float) -> dict[str, float]:
    """What MpcAllocator assumes of the tyres on this road."""
    from fmus.cars import published  # noqa: PLC0415
    from fmus.cars.grip import with_grip  # noqa: PLC0415

    here = with_grip(published.single_track(), mu)
    return {
        f"design.tyre.{axle}.{name}": value
        for axle, tyre in (("front", here.front), ("rear", here.rear))
        for name, value in (("stiffness_factor", tyre.B), ("peak", tyre.D))
    }


def draw(results: Results, file: Path, title: str) -> None:
    """overview.png."""
    from scenarios.collision_avoidance.picture import draw_overview  # noqa: PLC0415  (slow to import)

    draw_overview(results, file, title)
