"""FMU states replay exactly; bytes that are not sound are refused without damage."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest
from fmu_driver import Instance

Make = Callable[[str], Instance]


def _run(instance: Instance, count: int = 12) -> list[dict[str, float]]:
    seen = []
    for k in range(count):
        name = "force" if "force" in instance.variables else "measured"
        instance.set({name: math.sin(k)})
        assert instance.step(2e-3), instance.messages
        seen.append(instance.outputs())
    return seen


@pytest.mark.parametrize("model", ["DemoSpring", "DemoFilter"])
def test_state_replays(make: Make, model: str) -> None:
    instance = make(model).initialise()
    _run(instance, 7)
    state, time = instance.fmu.getFMUstate(), instance.time
    first = _run(instance)
    instance.fmu.setFMUstate(state)
    instance.time = time
    assert _run(instance) == first
    instance.fmu.freeFMUstate(state)


@pytest.mark.parametrize("model", ["DemoSpring", "DemoFilter"])
def test_serialised_state_replays_in_another_instance(make: Make, model: str) -> None:
    instance, other = make(model).initialise(), make(model)
    _run(instance, 7)
    state = instance.fmu.getFMUstate()
    data, time = instance.fmu.serializeFMUstate(state), instance.time
    first = _run(instance)
    restored = other.fmu.deSerializeFMUstate(data)
    other.fmu.setFMUstate(restored)
    other.time = time
    assert _run(other) == first
    assert other.messages == []


def test_changed_foreign_and_short_bytes_are_refused(make: Make) -> None:
    instance, spring = make("DemoFilter").initialise(), make("DemoSpring").initialise()
    _run(instance, 3)
    data = instance.fmu.serializeFMUstate(instance.fmu.getFMUstate())
    foreign = spring.fmu.serializeFMUstate(spring.fmu.getFMUstate())
    flipped = [bytes([*data[:i], data[i] ^ 1, *data[i + 1 :]]) for i in range(0, len(data), 7)]
    for bad in [foreign, data[:-1], data + b"x", b"", b"\x80\x04K\x01.", *flipped]:
        before = instance.outputs()
        instance.messages.clear()
        instance.fmu.setFMUstate(instance.fmu.deSerializeFMUstate(bad))
        assert len(instance.messages) == 1
        assert "FMU state is refused" in instance.messages[0]
        assert instance.outputs() == {**before, "fault": 1}
        assert not instance.step(1e-3)
    assert instance.step(1e-3)
