"""One FMU instance beside what it must be: every call is predicted, made, and compared with the prediction.

What an instance is, hidden states included, is read from its serialised state. The prediction (`Twin`) knows the life
cycle, the parameters and inputs, and the faults; it knows nothing of the equations.
"""

from __future__ import annotations

import math
import os
from array import array
from collections.abc import Callable, Sequence
from ctypes import c_void_p
from dataclasses import dataclass, field, replace

from raw_fmi import DISCARD, OK, Fmu, Instance

from fmukit.runtime.description import Description
from fmukit.runtime.state import Refused, Snapshot, from_bytes

INSTANTIATED, INITIALISING, STEPPING, TERMINATED = range(4)
Call = Callable[[], int]


@dataclass
class Subject:
    """The FMU under test, and where its calls are written down before they are made."""

    fmu: Fmu
    journal: int
    calls: int = 0
    counts: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        (path,) = (self.fmu.folder / "resources").glob("*/interface.json")
        self.description = Description.read(path)
        self.fresh = _values(self.fmu)

    def note(self, text: str) -> None:
        self.calls += 1
        os.write(self.journal, f"{text[:400]}\n".encode())

    def begin(self) -> None:
        """A new sequence: the journal holds no more than one."""
        os.lseek(self.journal, 0, os.SEEK_SET)
        os.ftruncate(self.journal, 0)
        self.count("sequences")

    def count(self, what: str) -> None:
        self.counts[what] = self.counts.get(what, 0) + 1


@dataclass(frozen=True)
class Twin:
    """What must be true of the instance; `values` are those of parameters and inputs by value reference."""

    values: dict[int, object]
    mode: int = INSTANTIATED
    fault: bool = False
    pending: bool = False
    broken: bool = False
    time: float | None = None

    def refused(self) -> Twin:
        return replace(self, fault=True, pending=True)


class Life:
    def __init__(self, subject: Subject, name: str) -> None:
        self.subject, self.name = subject, name
        subject.note(f"{name}: instantiate")
        self.instance: Instance = subject.fmu.instantiate(name)
        self.twin = Twin(dict(subject.fresh))
        self.image = self.look()
        self.agree()

    # what is

    def look(self) -> Snapshot:
        """The whole state; finite, or it would not be readable."""
        state = c_void_p()
        assert self.instance.get_state(state) == OK
        status, data = self.instance.serialise(state)
        assert status == OK
        assert self.instance.free_state(state) == OK
        snapshot = from_bytes(data, self.subject.description)
        assert not isinstance(snapshot, Refused), f"the state is not sound: {snapshot.reason}"
        return snapshot

    def agree(self) -> None:
        """The instance is what the twin says."""
        image, twin, buffer = self.image, self.twin, array("d", self.image.buffer)
        life = image.life
        assert (life.mode, life.pending, life.broken) == (twin.mode, twin.pending, twin.broken)
        assert buffer[self.subject.description.fault] == float(twin.fault)
        assert (life.time if life.anchored else None) == twin.time
        strings = dict(image.strings)
        for vr, value in twin.values.items():
            assert (strings[vr] if isinstance(value, str) else buffer[vr]) == value

    def same(self, before: Snapshot, after: Snapshot) -> bool:
        """Equal but for the marks a refused call leaves, and for the promise to compute outputs anew."""
        return self._unmarked(before) == self._unmarked(after)

    def _unmarked(self, snapshot: Snapshot) -> Snapshot:
        buffer = array("d", snapshot.buffer)
        buffer[self.subject.description.fault] = 0.0
        life = replace(snapshot.life, pending=False, broken=False, dirty=False)
        return replace(snapshot, buffer=buffer.tobytes(), life=life)

    # what is done

    def make(self, text: str, call: Call, then: Twin, legal: Sequence[int] = (OK,)) -> int:
        """Make a call after which the twin is `then`."""
        self.subject.note(f"{self.name}: {text}")
        self.instance.messages.clear()
        status = call()
        assert status in legal, f"{text}: status {status}"
        self.image, self.twin = self.look(), then
        self.agree()
        return status

    def refuse(self, text: str, call: Call, legal: Sequence[int] = (OK,)) -> None:
        """A call that must be refused: it says why and changes nothing."""
        before = self.image
        self.subject.count("refused")
        self.make(text, call, self.twin.refused(), legal)
        assert self.instance.messages, f"{text}: refused without a message"
        assert self.same(before, self.image), f"{text}: a refused call changed the state"

    def refuse_reading(self, text: str, call: Call) -> None:
        """As `refuse`, but there is nothing a step could suffer from."""
        before = self.image
        self.subject.count("refused")
        self.make(text, call, self.twin)
        assert self.instance.messages, f"{text}: refused without a message"
        assert before == self.image, f"{text}: a refused call changed the state"

    def only_in(self, mode: int, text: str, call: Call, then: int) -> None:
        if self.twin.mode == mode:
            self.make(text, call, replace(self.twin, mode=then))
        else:
            self.refuse(text, call)

    def setup(self, start: float = 0.0) -> None:
        self.only_in(INSTANTIATED, f"setupExperiment {start}", lambda: self.instance.setup(start), INSTANTIATED)

    def enter(self) -> None:
        call = lambda: self.instance.call("EnterInitializationMode")  # noqa: E731
        self.only_in(INSTANTIATED, "enterInitializationMode", call, INITIALISING)

    def terminate(self) -> None:
        self.only_in(STEPPING, "terminate", lambda: self.instance.call("Terminate"), TERMINATED)

    def exit(self) -> None:
        call = lambda: self.instance.call("ExitInitializationMode")  # noqa: E731
        if self.twin.mode != INITIALISING:
            return self.refuse("exitInitializationMode", call)
        self.subject.note(f"{self.name}: exitInitializationMode")
        self.instance.messages.clear()
        assert call() == OK
        self.image = self.look()
        self.twin = replace(self.twin, mode=STEPPING)
        if self.image.life.broken:
            assert self.twin.values != self.subject.fresh, f"start values do not work: {self.instance.messages}"
            assert _says(self.instance, "initialisation failed", "table "), self.instance.messages
            self.twin = replace(self.twin.refused(), broken=True)
            self.subject.count("initialisation failed")
        self.agree()

    def reset(self) -> None:
        self.make("reset", lambda: self.instance.call("Reset"), Twin(dict(self.subject.fresh)))

    def run(self) -> None:
        """Legally to the first step."""
        if self.twin.mode != INSTANTIATED:
            self.reset()
        self.setup()
        self.enter()
        self.exit()

    def step(self, time: float, size: float) -> None:
        twin, before, text = self.twin, self.image, f"doStep {time!r} {size!r}"
        call = lambda: self.instance.step(time, size)  # noqa: E731
        slack = 1e-6 * self.subject.description.step
        possible = 0.0 < size <= 1e9 and abs(time) <= 1e12 and (twin.time is None or time >= twin.time - slack)
        if twin.mode != STEPPING or twin.pending or twin.broken or not possible:
            self.make(text, call, replace(twin, fault=True, pending=False), [DISCARD])
            assert self.same(before, self.image), f"{text}: a discarded step changed the state"
            return
        self.subject.note(f"{self.name}: {text}")
        self.instance.messages.clear()
        status = call()
        self.image = self.look()
        if status == OK:
            self.twin = replace(twin, fault=False, time=time + size)
            self.subject.count("steps")
        else:
            assert status == DISCARD, f"{text}: status {status}"
            assert _says(self.instance, "failed: "), self.instance.messages
            assert self.same(before, self.image), f"{text}: a failed step changed the state"
            self.twin = replace(twin, fault=True)
            self.subject.count("failed steps")
        self.agree()

    def set(self, type_: str, vrs: list[int], values: list[object]) -> None:
        text, call = f"set{type_} {vrs} {values}", lambda: self.instance.set(type_, vrs, values)
        taken = [_taken(type_, value) for value in values]
        if self._settable(type_, vrs, taken):
            then = self.twin.values | dict(zip(vrs, taken, strict=True))
            before, outputs = self.image, self._unset(vrs)
            self.make(text, call, replace(self.twin, values=then))
            assert self._unset(vrs) == outputs, f"{text}: something else changed"
            assert before.life.time == self.image.life.time
        else:
            self.refuse(text, call)

    def _unset(self, vrs: list[int]) -> array[float]:
        buffer = array("d", self.image.buffer)
        for vr in vrs:
            buffer[vr] = 0.0
        return buffer

    def _settable(self, type_: str, vrs: list[int], taken: list[object]) -> bool:
        about, mode = self.subject.description.scalars, self.twin.mode
        if mode == TERMINATED or not all(vr < len(about) and about[vr].type == type_ for vr in vrs):
            return False
        ports = [about[vr] for vr in vrs]
        causes = {port.causality for port in ports}
        if "output" in causes or (mode == STEPPING and "parameter" in causes):
            return False
        pairs = zip(ports, taken, strict=True)
        return all(v is not None and (isinstance(v, str) or port.low <= v <= port.high) for port, v in pairs)

    def get(self, type_: str, vrs: list[int]) -> None:
        about, text, got = self.subject.description.scalars, f"get{type_} {vrs}", []

        def call() -> int:
            status, values = self.instance.get(type_, vrs)
            got.extend(values)
            return status

        if not all(vr < len(about) and about[vr].type == type_ for vr in vrs):
            return self.refuse_reading(text, call)
        before = self.image
        self.make(text, call, self.twin)
        assert self.twin.mode == INITIALISING or self.image == before, f"{text}: reading changed the state"
        buffer, strings = array("d", self.image.buffer), dict(self.image.strings)
        assert got == [strings[vr].encode() if type_ == "String" else buffer[vr] for vr in vrs], text

    def unsupported(self, function: str, *arguments: object) -> None:
        """Calls PythonFMU does not offer say so, and change nothing."""
        before = self.image
        self.make(function, lambda: self.instance.call(function, *arguments), self.twin, [3])
        assert before == self.image

    def restore(self, state: c_void_p, twin: Twin, image: Snapshot) -> None:
        self.make("setFMUstate", lambda: self.instance.set_state(state), twin)
        assert self.image == image, "the restored state is not the saved one"

    def save(self) -> c_void_p:
        state = c_void_p()
        self.make("getFMUstate", lambda: self.instance.get_state(state), self.twin)
        return state

    def free(self) -> None:
        self.subject.note(f"{self.name}: free")
        self.instance.free()


def _says(instance: Instance, *words: str) -> bool:
    return len(instance.messages) == 1 and any(word in instance.messages[0] for word in words)


def _taken(type_: str, value: object) -> object:
    """The value as the slot holds it; None for a text that is none."""
    if type_ == "String":
        try:
            return None if value is None else bytes(value).decode()  # type: ignore[call-overload]
        except UnicodeDecodeError:
            return None
    if type_ == "Boolean":
        return float(bool(value))
    number = float(value)  # type: ignore[arg-type]
    return None if math.isnan(number) else number


def _values(fmu: Fmu) -> dict[int, object]:
    """Start values of parameters and inputs."""

    def value(type_: str, text: str) -> object:
        if type_ == "String":
            return text
        return float(text == "true") if type_ == "Boolean" else float(text)

    return {v.vr: value(v.type, v.start or "") for v in fmu.variables if v.causality != "output"}
