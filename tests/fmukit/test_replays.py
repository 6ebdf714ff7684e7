"""An FMU of the catalogue that goes back to one of its states comes by the same way again, whatever is switched on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest
from fmu_driver import Instance
from regimes import Values, regime

from fmukit.component import Component
from fmukit.interface import Variable
from fmus import CATALOGUE

Make = Callable[[Component], Instance]

_SWITCHES = [
    pytest.param(component, variable, id=f"{component.interface.name}-{variable.name}")
    for component in CATALOGUE
    for variable in component.interface.select("parameter")
    if variable.type == "Boolean"
]
_UNTIL = {"replan.from_estimate": 20}
"""Percent of the drive that are played: with this switch there is a search at every sample."""


def _replays(component: Component, fresh: Make, part: slice, switched: Mapping[str, object]) -> list[list[Values]]:
    """What is seen in a part of the drive (percent): at once, again, and from bytes in another instance."""
    step, drive = component.interface.step, regime(component.interface)
    script = drive.script(step)
    done, script = round(0.01 * part.start * len(script)), script[: round(0.01 * part.stop * len(script))]
    instance, other = fresh(component).initialise({**drive.parameters, **switched}), fresh(component)
    instance.play(script[:done], step)
    state, time = instance.fmu.getFMUstate(), instance.time
    data = instance.fmu.serializeFMUstate(state)
    seen = [instance.play(script[done:], step)]
    instance.fmu.setFMUstate(state)
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(data))
    for player in (instance, other):
        player.time = time
        seen.append(player.play(script[done:], step))
    return seen


@pytest.mark.parametrize("component", CATALOGUE, ids=lambda component: component.interface.name)
def test_state_replays_in_place_and_from_bytes(component: Component, fresh: Make) -> None:
    first, *again = _replays(component, fresh, slice(50, 100), {})
    assert again == [first, first]


@pytest.mark.parametrize(("component", "switch"), _SWITCHES)
def test_state_replays_with_a_switch_turned(
    component: Component, switch: Variable, fresh: Make, tmp_path: Path
) -> None:
    """To the bit, but for the durations that `solver.timed` measures. The start of the drive is in the replay."""
    switched = {switch.name: not switch.start}
    if switch.name == "road.closed":
        switched |= {"road_file": _ring(tmp_path / "ring.csv")}
    seen = _replays(component, fresh, slice(10, _UNTIL.get(switch.name, 100)), switched)
    if switch.name == "solver.timed":
        measured = [name for name in component.interface.names("output") if name.endswith(".time")]
        for outputs in (outputs for play in seen for outputs in play):
            assert all(outputs.pop(name) > 0.0 for name in measured)
    if switch.name == "grip.enabled":
        assert seen[0][0]["friction.counted"] > 0.9 > seen[0][-1]["friction.counted"]
    assert seen[1:] == [seen[0], seen[0]]


def _ring(file: Path) -> str:
    """Path of a closed road, a circle of 60 m."""
    turns = [2 * math.pi * k / 120 for k in range(120)]
    rows = [f"{60 * math.cos(turn)},{60 * math.sin(turn)},4,4" for turn in turns]
    file.write_text("\n".join(["x_m,y_m,w_tr_right_m,w_tr_left_m", *rows]), "utf-8")
    return str(file)
