"""What the formation scenarios share: their settings, and how these make a system."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from cosim.model.system import System
from cosim.results.reading import Results
from cosim.scenario import NumberSetting, Scenario, Setting, Settings
from scenarios.formation.distances import distance_metrics
from scenarios.formation.leads import tell_the_leads
from scenarios.formation.metrics import follower_errors, formation_metrics, warn_of_few_rows
from scenarios.formation.start import start_in_formation
from scenarios.formation.string_stability import ratio_metrics
from scenarios.formation.system import HEAD, PLANTS, Cars, Law, change_of_shape, formation, name
from scenarios.formation.topology import TOPOLOGIES, Spacing, topology
from scenarios.shared.catalogue import fmu_path
from scenarios.shared.sensors import SETTINGS
from scenarios.tracking.loop import tell_the_actuator

MOST = 100
_RECORD = 0.02
"""Seconds from row to row: the period of the followers. A row every millisecond would be gigabytes for ten cars."""
UNRECORDED = ("*.fl", "*.fr", "*.rl", "*.rr")
"""What belongs to single wheels: a third of all signals, and of the memory of many cars."""
_SPACING = 10.0  # m; 5.3 m from bumper to bumper
_IN_A_ROW = ("chain", "star")
Shapes = Sequence[tuple[float, str]]
"""When [s] the formation changes to which shape."""


def formation_settings(vehicles: int, kind: str, spacing: float = 12.0) -> dict[str, Setting | NumberSetting]:
    """The settings of a formation: of `vehicles` cars, topology `kind` and `spacing` [m] unless told otherwise."""
    return {
        "vehicles": NumberSetting(vehicles, 1, MOST, "1", "number of cars, the head included", whole=True),
        "topology": Setting(kind, tuple(TOPOLOGIES), "who follows whom, and the shape at the start"),
        "plant": Setting("16dof", tuple(PLANTS), "what drives"),
        **SETTINGS,
        "radio": Setting("on", ("on", "off"), "messages at 10 Hz, late and noisy; off: known at once"),
        "headway": NumberSetting(0.0, 0.0, 3.0, "s", "the wanted place moves back by this times the own speed"),
        "feedforward": Setting("off", ("on", "off"), "the head broadcasts its speed to all followers"),
        "spacing": NumberSetting(spacing, 6.0, 100.0, "m", "from rank to rank, O1 to O1"),
        "lateral_spacing": NumberSetting(4.0, 2.5, 20.0, "m", "from file to file"),
        "initial_error": NumberSetting(0.0, 0.0, 10.0, "m", "how far followers start beside their places, about"),
    }


def weaving(width: float) -> dict[str, float]:
    """Parameters of ReferenceTrajectory: from 20 to 30 m/s, while four bends of `width` [s] weave left and right.

    At 25 m/s the yaw rate of a bend is 0.12 rad/s (engineering choice, like all of it).
    """
    return {
        **{"initial_speed": 20.0, "acceleration": 1.0, "deceleration": 0.0},
        **{"acceleration.start": 2.0, "acceleration.end": 13.0, "acceleration.rise": 1.0},
        **{"amplitude": 3.0, "weave.start": 3.0, "weave.width": width, "weave.rise": 0.4 * width, "turn.ratio": 0.0},
    }


def formation_scenario(
    called: str, title: str, figures: str, stop_time: float, *, law: Law, cars: Cars, kind: str, shapes: Shapes = ()
) -> Scenario:
    """A formation of four cars that changes its shape at given times."""
    return Scenario(
        name=called,
        title=title,
        figures=figures,
        stop_time=stop_time,
        build=lambda settings: formation_system(settings, law, cars, shapes),
        complete=complete,
        find=fmu_path,
        metrics=metrics,
        draw=draw,
        record_every=_RECORD,
        unrecorded=UNRECORDED,
        settings=formation_settings(4, kind, _SPACING),
    )


def formation_system(settings: Settings, law: Law, cars: Cars, shapes: Shapes) -> System:
    """The formation the settings describe."""
    size, kind, spacing = int(settings["vehicles"]), settings["topology"], _spacing(settings)
    timetable = [change_of_shape(time, shape, size, kind, spacing) for time, shape in shapes]
    return formation(size, kind, law, timetable, settings, replace(cars, plant=settings["plant"]), spacing)


def complete(system: System, settings: Settings) -> None:
    """What follows from the user's values: where the cars start, and what they are told of their own delays."""
    start_in_formation(system, leaders(settings), settings["initial_error"])
    if f"{name(HEAD)}llc" in system.instances:
        tell_the_actuator(system, name(HEAD))
    tell_the_leads(system, leaders(settings))


def leaders(settings: Settings) -> Mapping[int, int]:
    """By number of the follower: the car it follows."""
    return topology(settings["topology"]).leaders(int(settings["vehicles"]))


def _spacing(settings: Settings) -> Spacing:
    return Spacing(settings["spacing"], settings["lateral_spacing"])


def metrics(results: Results) -> dict[str, float]:
    """How well every follower kept its place, how near cars came, and in a row whether errors grow from car to car."""
    follows = leaders(results.settings)
    warn_of_few_rows(results, follows)
    found = {**formation_metrics(results, follows), **distance_metrics(results, (HEAD, *follows))}
    if results.settings["topology"] in _IN_A_ROW:
        found |= ratio_metrics({k: follower_errors(results, k, leader).hand for k, leader in follows.items()})
    return found


def draw(results: Results, file: Path, title: str) -> None:
    """overview.png."""
    from scenarios.formation.picture import draw_overview  # noqa: PLC0415  (slow to import)

    draw_overview(results, file, title, leaders(results.settings))
