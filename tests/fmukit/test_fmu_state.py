"""FMU states replay exactly; bytes that are not sound are refused without damage."""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from hashlib import blake2b

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


@pytest.mark.parametrize("value", [1e4 + 1, -2e4])
def test_values_outside_their_limits_are_refused(make: Make, value: float) -> None:
    """Though the digest is right: whoever changes bytes can compute one."""
    instance = make("DemoSpring").initialise()
    _run(instance, 3)
    data = bytes(instance.fmu.serializeFMUstate(instance.fmu.getFMUstate()))
    old = struct.pack("d", math.sin(2))
    assert data.count(old) == 1
    content = data.replace(old, struct.pack("d", value))[:-16]
    before = instance.outputs()
    instance.fmu.setFMUstate(instance.fmu.deSerializeFMUstate(content + blake2b(content, digest_size=16).digest()))
    assert f"hold force = {value!r}, which is outside [-10000, 10000]" in instance.messages[0]
    assert instance.outputs() | {"fault": 0.0} == before | {"fault": 0.0}
