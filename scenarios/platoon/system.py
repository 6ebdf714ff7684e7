"""Cars in a row on a straight: what disturbs them, when, and the system.

With a time headway h the wanted place of a follower moves back by h times its own speed. In a chain that widens every
gap, in a star it moves all followers back alike.

`HEADWAY` is the one at which nothing grows. Along the road, the motion of a follower is that of its leader times Gamma,

    1/Gamma = 1 + h s (1 + tau s) + s^2 (1 + tau s)(1 + (tau_r + h) s)/(K s + K_i)

with the lag tau of the speed behind its command, tau_r = `realise.speed_time` and the rate K_i at which the network's
bias integrates; at low frequency |1/Gamma|^2 = 1 + omega^2 (h^2 - 2 h tau - 2/K_i), so h >= tau + sqrt(tau^2 + 2/K_i).

Across the road, the wanted point at r in the leader's axes swings with its yaw angle, and a hand point a ahead of O1
answers with y (1 + s a/v): what the law makes of it is multiplied by (1 + s r/v)/(1 + s a/v). With r = a - gap the
swinging grows from car to car unless a >= gap/2; the hand point is therefore put where the leader is, r = 0.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cosim.errors import CosimError
from cosim.model.signals import Vector
from cosim.model.system import System
from cosim.scenario import NumberSetting, Setting, Settings
from scenarios.formation.scenario import complete as complete_formation
from scenarios.formation.scenario import formation_settings
from scenarios.formation.system import HEAD, Cars, Law, formation, name
from scenarios.formation.topology import Spacing
from scenarios.platoon import excitation, row
from scenarios.platoon.row import SPEED
from scenarios.shared.plans import kept

END = 80.0
_ALL = {"push": (4.0, 16.0), "merge": (16.0, 46.0), "braking": (46.0, 78.0), "sweep": (0.0, END)}
_ALONE = {"push": (4.0, 16.0), "merge": (4.0, 34.0), "braking": (8.0, 40.0), "sweep": (0.0, END)}
"""When [s] each event begins and has died out, in all events together and alone."""
SETTLED = END - excitation.PERIOD
"""When [s] the answer to the sweep has become periodic."""
HEADWAY = 1.0
"""[s]; with K = 3/s and K_i = 5/s2 a lag of the speed of 0.1 s needs 0.78 s, one of 0.2 s 0.92 s."""
GAIN = 3.0
_FIRM = {"gain": GAIN, "adaptation.output": GAIN**2 / 7.0, "adaptation.hidden": GAIN**2 / 14.0}
"""K, F and G of adaptive followers: firmer than their start values, which halves errors and headway."""
_TOLD = {"gain": 2.0, "adaptation.output": 0.01, "adaptation.hidden": 0.005}
"""The same while they are told the head's speed, which makes errors small but not their ratio: that is T of the law, so
it takes a network that learns slowly and a gain that the lags leave well damped."""
_BACK = {"headway.filter": 5.0}
"""Of constraint followers: with the slower filter they start with, they pass on fast motions as without headway."""
SWEEP = 0.8
"""Root mean square of the head's acceleration in the sweep [m/s2]; the largest is 2 m/s2."""
_PUSHED = 3
_FORCE, _FORCE_TIME = -6000.0, 1.0  # N, s
_MOVE_IN = 14.0  # s after the gap began to open
_DURATION = 12.0  # s; a gap of one headway opens so slowly that nobody brakes hard
LAWS = {"adaptive": ("AdaptiveFollower", False), "constraint": ("ConstraintFollower", True)}
"""Model, and whether it wants to know its leader's motion."""
SETTINGS = {
    **formation_settings(10, "chain"),
    "topology": Setting("chain", ("chain", "star"), "who follows whom: the car ahead, or all the head"),
    "headway": NumberSetting(HEADWAY, 0.0, 3.0, "s", "the wanted place moves back by this times the own speed"),
    "law": Setting("adaptive", tuple(LAWS), "how followers keep their places"),
    "manoeuvre": Setting(
        "events",
        ("events", "push", "braking", "merge", "sweep", "quiet"),
        "all events one after another, one of them, a sweep, or nothing",
    ),
}


def system(settings: Settings) -> System:
    """The platoon and what happens to it."""
    size, gap = int(settings["vehicles"]), Spacing(settings["spacing"], settings["lateral_spacing"])
    cars = Cars(settings["plant"], reference={"trajectory_file": str(_head_file(settings))})
    merging = row.merging(settings) if happens(settings, "merge") else None
    timetable = [] if merging is None else row.merge(settings, merging, _merging_times(settings))
    made = formation(size, settings["topology"], _law(settings), timetable, settings, cars, gap)
    row.reach(made, settings)
    if merging is not None:
        row.start_beside(made, settings, merging)
    if happens(settings, "push"):
        _push(made, settings)
    return made


def complete(made: System, settings: Settings) -> None:
    """As in every formation; raises CosimError for another trajectory of the head than is measured."""
    file = str(made.instances[f"{name(HEAD)}reference"].parameters.get("trajectory_file", ""))
    if file != str(_head_file(settings)):
        raise CosimError(
            f"{name(HEAD)}reference.trajectory_file is the manoeuvre of the scenario; set scenario.manoeuvre"
        )
    complete_formation(made, settings)


def happens(settings: Settings, event: str) -> bool:
    """Whether `event` ("push", "braking", "merge", "sweep") is part of the manoeuvre."""
    return settings["manoeuvre"] == event or (settings["manoeuvre"] == "events" and event != "sweep")


def pushed(settings: Settings) -> int:
    """The car that is pushed: the third one."""
    return min(_PUSHED, int(settings["vehicles"]))


def _law(settings: Settings) -> Law:
    model, motion = LAWS[settings["law"]]
    own, told = (_BACK, {}) if motion else (_FIRM, _TOLD)
    return Law(model, motion, {"formation.duration": _DURATION, **own}, told)


def span(settings: Settings, event: str) -> tuple[float, float]:
    """When [s] the event begins and has died out."""
    return (_ALL if settings["manoeuvre"] == "events" else _ALONE)[event]


def _merging_times(settings: Settings) -> tuple[float, float]:
    begin, _ = span(settings, "merge")
    return begin, begin + _MOVE_IN


def _head_file(settings: Settings) -> Path:
    from fmus.controllers.reference.interface import COLUMNS  # noqa: PLC0415  (lazy: `cosim list`)
    from fmus.planner.files import write_table  # noqa: PLC0415

    t = np.linspace(0.0, END + 5.0, 3401)
    rows = excitation.straight(t, *_motion(t, settings))
    return kept(
        "platoon", [rows.tobytes()], lambda file: write_table(COLUMNS, rows, file), "writing how the head drives in"
    )


def _motion(t: Vector, settings: Settings) -> tuple[Vector, Vector]:
    """Speed (n,) [m/s] of the head and its rate (n,) [m/s2]."""
    speed, rate = np.full_like(t, SPEED), np.zeros_like(t)
    if happens(settings, "sweep"):
        more = excitation.multisine(t, SWEEP)
    elif happens(settings, "braking"):
        more = excitation.braking(t - span(settings, "braking")[0])
    else:
        return speed, rate
    return speed + more[0], rate + more[1]


def _push(made: System, settings: Settings) -> None:
    car = pushed(settings)
    begin, _ = span(settings, "push")
    made.at(begin, f"{name(car)}plant.body_force.x", _FORCE)
    made.at(begin + _FORCE_TIME, f"{name(car)}plant.body_force.x", 0.0)
