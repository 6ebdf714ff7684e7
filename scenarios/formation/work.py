"""What the scenarios of formations do that change their shape at given times."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from cosim.model.face import Value
from cosim.scenario.definition import Work
from scenarios.formation.complete import complete_formation
from scenarios.formation.law import Law
from scenarios.formation.limits import LIMITS
from scenarios.formation.metrics import formation_metrics
from scenarios.formation.system import formation_system
from scenarios.formation.timetable import Shapes, arranged


def formation_work(law: Law, reference: Mapping[str, Value], shapes: Shapes) -> Work:
    """A formation of followers by `law`, whose head drives the manoeuvre `reference` of ReferenceTrajectory."""
    return Work(
        prepare=partial(arranged, shapes),
        build=partial(formation_system, law, reference),
        complete=complete_formation,
        metrics=formation_metrics,
        limits=LIMITS,
        picture="scenarios.formation.picture",
    )


def weaving(width: float) -> dict[str, float]:
    """Parameters of ReferenceTrajectory: from 20 to 30 m/s, while four bends of `width` [s] weave left and right.

    At 25 m/s the yaw rate of a bend is 0.12 rad/s (engineering choice, like all of it).
    """
    return {
        **{"initial_speed": 20.0, "acceleration": 1.0, "deceleration": 0.0},
        **{"acceleration.start": 2.0, "acceleration.end": 13.0, "acceleration.rise": 1.0},
        **{"amplitude": 3.0, "weave.start": 3.0, "weave.width": width, "weave.rise": 0.4 * width, "turn.ratio": 0.0},
    }
