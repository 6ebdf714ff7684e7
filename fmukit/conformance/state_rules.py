"""Rules of behaviour, continued: FMU states hold everything, and bytes that are not sound are refused."""

from __future__ import annotations

import random
from collections.abc import Iterator
from ctypes import byref
from functools import partial

from fmukit.conformance import errand
from fmukit.conformance.bare import host
from fmukit.conformance.bench import Bench
from fmukit.conformance.disturbance import attempt, unharmed, verdict
from fmukit.conformance.rule import NotApplicable, Rules

RULES: Rules[Bench] = Rules()
_BEFORE = 10
_FLIPS = 40


@RULES.add(
    "B7",
    "A restored FMU state replays the run exactly",
    "2.1.8",
    "put everything the future depends on into the FMU state, also what is not a variable",
)
def replay_in_place(bench: Bench) -> Iterator[str]:
    bench.requires("canGetAndSetFMUstate", "it has no FMU states")
    yield from _differences_in_place(bench)


def _differences_in_place(bench: Bench) -> list[str]:
    return bench.remember("replay in place", lambda: list(_replay_in_place(bench)))


def _replay_in_place(bench: Bench) -> Iterator[str]:
    expected = bench.reference()[1 + _BEFORE :]
    instance = bench.lead("stepping", _BEFORE)
    state = instance.state()
    host.steps(instance, bench.experiment, _BEFORE)
    for after in ("after running on", "a second time", "after a reset"):
        if after == "after a reset":
            instance.must("Reset")
        instance.restore(state)
        changed = bench.difference(host.steps(instance, bench.experiment, _BEFORE), expected)
        if changed:
            yield f"restored {after}, the run differs: {changed}"
    instance.forget(state)
    instance.free()


@RULES.add(
    "B8",
    "A serialised FMU state replays in another instance",
    "2.1.8",
    "serialise all of the FMU state, not only the variables",
)
def replay_elsewhere(bench: Bench) -> Iterator[str]:
    _needs_sound_states(bench)
    yield from _differences_elsewhere(bench)


def _differences_elsewhere(bench: Bench) -> list[str]:
    return bench.remember("replay elsewhere", lambda: list(_replay_elsewhere(bench)))


def _replay_elsewhere(bench: Bench) -> Iterator[str]:
    expected = bench.reference()[1 + _BEFORE :]
    data, other = _bytes(bench), bench.make("another")
    status, state = other.from_bytes(data)
    other.expect("fmi2DeSerializeFMUstate", status)
    other.restore(state)
    changed = bench.difference(host.steps(other, bench.experiment, _BEFORE), expected)
    if changed:
        yield f"restored from bytes in another instance, the run differs: {changed}"
    other.forget(state)
    other.free()


@RULES.add(
    "B9",
    "A serialised FMU state replays in another process",
    "2.1.8",
    "let the bytes stand on their own: no pointers, no indices into memory of the process that wrote them",
)
def replay_in_another_process(bench: Bench) -> Iterator[str]:
    _needs_sound_states(bench)
    if _differences_elsewhere(bench):
        raise NotApplicable("serialised states do not even replay in the same process")
    task = errand.rest(bench.target, bench.experiment, _bytes(bench), _BEFORE)
    changed = bench.difference(errand.send([task])[0][0], bench.reference()[1 + _BEFORE :])
    if changed:
        yield f"restored from bytes in another process, the run differs: {changed}"


@RULES.add(
    "B21",
    "Freed FMU states are marked as freed",
    "2.1.8",
    "let fmi2FreeFMUstate set the pointer it is given to null, and do nothing if it is null already",
)
def freed_states(bench: Bench) -> Iterator[str]:
    bench.requires("canGetAndSetFMUstate", "it has no FMU states")
    if bench.package.python:
        raise NotApplicable("the binary of PythonFMU leaves the pointer as it is, which no Python code can mend")
    instance = bench.lead("stepping")
    state = instance.state()
    instance.forget(state)
    if state.value:
        yield "fmi2FreeFMUstate leaves the pointer to the state that it has freed"
    else:
        status = instance.call("FreeFMUstate", byref(state))
        if status > host.WARNING:
            yield f"fmi2FreeFMUstate answers {host.word(status)} to a null pointer"
    instance.free()


@RULES.add(
    "B10",
    "Damaged or foreign bytes are refused as FMU state",
    "good practice",
    "put a checksum and the GUID into the bytes, and check them and the length before using anything",
)
def tampered_bytes(bench: Bench) -> Iterator[str]:
    _needs_sound_states(bench)
    data = _bytes(bench)
    for what, bad in _tampered(bench, data):
        instance = bench.lead("stepping")
        status, said = attempt(instance, partial(_load, data=bad))
        seen = list(verdict(what, status, said))
        yield from seen
        if seen:
            return
        yield from unharmed(bench, instance, "stepping", status, what)


def _tampered(bench: Bench, data: bytes) -> Iterator[tuple[str, bytes]]:
    generator = random.Random(bench.package.identifier)
    yield "an FMU state without its last byte", data[:-1]
    yield "the first half of an FMU state", data[: len(data) // 2]
    yield "an FMU state of no bytes", b""
    yield "an FMU state with a byte too many", data + b"\0"
    yield "random bytes as FMU state", generator.randbytes(len(data))
    for other in bench.others:
        if other.package.flag("canSerializeFMUstate"):
            yield f"an FMU state of {other.package.identifier}", _bytes(other)
    for _ in range(_FLIPS):
        place = generator.randrange(len(data))
        flipped = bytes([data[place] ^ (1 << generator.randrange(8))])
        yield f"an FMU state with byte {place} changed", data[:place] + flipped + data[place + 1 :]


def _load(instance: host.RawInstance, data: bytes) -> int:
    status, state = instance.from_bytes(data)
    if status > host.WARNING:
        return status
    status = instance.call("SetFMUstate", state)
    instance.forget(state)
    return status


def _bytes(bench: Bench) -> bytes:
    """The FMU state after some steps, as bytes."""
    instance = bench.lead("stepping", _BEFORE)
    state = instance.state()
    data = instance.to_bytes(state)
    instance.forget(state)
    instance.free()
    return data


def _needs_sound_states(bench: Bench) -> None:
    bench.requires("canSerializeFMUstate", "its FMU states have no form as bytes")
    if _differences_in_place(bench):
        raise NotApplicable("restoring an FMU state already fails within one instance")
