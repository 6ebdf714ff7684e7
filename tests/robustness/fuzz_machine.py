"""Any sequence of FMI calls, legal or not, over two instances of one FMU."""

from __future__ import annotations

import math
from array import array
from ctypes import c_void_p
from typing import ClassVar

from fuzz_draws import ODD_STEPS, ODD_TIMES, STEPS, TYPES, Draws, any_value, legal
from fuzz_durations import replayable
from fuzz_life import STEPPING, Life, Subject, Twin
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, rule
from raw_fmi import OK, Variable

from fmukit.runtime.state import Snapshot

which = st.sampled_from((0, 0, 0, 1))
sizes_of_steps = st.lists(st.sampled_from(STEPS), min_size=1, max_size=4)


def machine(subject: Subject) -> type[RuleBasedStateMachine]:
    """The state machine of one FMU."""
    return type("Calls", (Calls,), {"subject": subject, "draws": Draws(subject.fmu.variables)})


class Calls(RuleBasedStateMachine):
    """`machine` makes the subclass of one FMU."""

    subject: ClassVar[Subject]
    draws: ClassVar[Draws]

    def __init__(self) -> None:
        super().__init__()
        self.subject.begin()
        self.lives: dict[int, Life] = {}
        self.states: list[tuple[Life, c_void_p, Twin, Snapshot]] = []

    def life(self, k: int) -> Life:
        if k not in self.lives:
            self.lives[k] = Life(self.subject, f"instance{k}")
        return self.lives[k]

    @rule(k=which)
    def run(self, k: int) -> None:
        self.life(k).run()

    @rule(k=which, start=st.sampled_from((0.0, 5.0, math.nan)))
    def setup(self, k: int, start: float) -> None:
        self.life(k).setup(start)

    @rule(k=which)
    def enter(self, k: int) -> None:
        self.life(k).enter()

    @rule(k=which)
    def exit(self, k: int) -> None:
        self.life(k).exit()

    @rule(k=which)
    def terminate(self, k: int) -> None:
        self.life(k).terminate()

    @rule(k=which)
    def reset(self, k: int) -> None:
        self.life(k).reset()

    @rule(k=which)
    def free(self, k: int) -> None:
        if k in self.lives:
            life = self.lives.pop(k)
            self._forget(life)
            life.free()

    @rule(k=which, data=st.data())
    def set_legal_values(self, k: int, data: st.DataObject) -> None:
        self._set(self.life(k), data.draw(self.draws.settable), data)

    @rule(k=which, data=st.data())
    def set_inputs(self, k: int, data: st.DataObject) -> None:
        self._set(self.life(k), data.draw(self.draws.inputs), data)

    def _set(self, life: Life, chosen: list[Variable], data: st.DataObject) -> None:
        for type_ in TYPES:
            some = [v for v in chosen if v.type == type_]
            if some:
                life.set(type_, [v.vr for v in some], [data.draw(legal(v)) for v in some])

    @rule(k=which, type_=st.sampled_from(TYPES), data=st.data())
    def set_anything(self, k: int, type_: str, data: st.DataObject) -> None:
        vrs = data.draw(self.draws.references[type_])
        if type_ == "String":
            self.subject.count("texts")
        self.life(k).set(type_, vrs, [data.draw(any_value(type_)) for _ in vrs])

    @rule(k=which, type_=st.sampled_from(TYPES), data=st.data())
    def get_anything(self, k: int, type_: str, data: st.DataObject) -> None:
        self.life(k).get(type_, data.draw(self.draws.references[type_]))

    @rule(k=which, sizes=sizes_of_steps)
    def step(self, k: int, sizes: list[float]) -> None:
        life = self.life(k)
        for size in sizes:
            life.step(life.twin.time or 0.0, size * self.subject.fmu.step)

    @rule(k=which, size=st.sampled_from(ODD_STEPS))
    def step_of_an_odd_size(self, k: int, size: float) -> None:
        life = self.life(k)
        life.step(life.twin.time or 0.0, size)

    @rule(k=which, shift=st.sampled_from((-0.5, -1e-9, 1e-9, 0.3, 7.0)), odd=st.sampled_from((None, *ODD_TIMES)))
    def step_from_an_odd_time(self, k: int, shift: float, odd: float | None) -> None:
        life = self.life(k)
        life.step(
            (life.twin.time or 0.0) + shift * self.subject.fmu.step if odd is None else odd, self.subject.fmu.step
        )

    @rule(k=which)
    def save(self, k: int) -> None:
        life = self.life(k)
        self.states.append((life, life.save(), life.twin, life.image))

    @rule(k=which, i=st.integers(0, 3))
    def restore(self, k: int, i: int) -> None:
        if self.states:
            _, state, twin, image = self.states[i % len(self.states)]
            self.life(k).restore(state, twin, image)

    @rule(k=which, i=st.integers(0, 3), at=st.one_of(st.none(), st.integers(0, 10**5)), cut=st.booleans())
    def restore_from_bytes(self, k: int, i: int, at: int | None, cut: bool) -> None:
        """As they were written, or with one bit changed (`at`), or cut off there."""
        if not self.states:
            return
        owner, state, twin, image = self.states[i % len(self.states)]
        status, data = owner.instance.serialise(state)
        assert status == OK
        if at is not None:
            at %= len(data)
            data = data[:at] if cut else bytes([*data[:at], data[at] ^ 1, *data[at + 1 :]])
        life, copy = self.life(k), c_void_p()
        self.subject.count("bytes")
        self.subject.note(f"{life.name}: deSerializeFMUstate of {len(data)} bytes, changed at {at}")
        assert life.instance.deserialise(data, copy) == OK
        if at is None:
            life.restore(copy, twin, image)
        else:
            life.refuse("setFMUstate of changed bytes", lambda: life.instance.set_state(copy))
        assert life.instance.free_state(copy) == OK

    @rule(k=which, sizes=sizes_of_steps, data=st.data())
    def replay(self, k: int, sizes: list[float], data: st.DataObject) -> None:
        """The same calls from the same state come to the same state, in this instance and in the other.

        But for measured durations, see `fuzz_durations`.
        """
        life, other = self.life(k), self.life(1 - k)
        if life.twin.mode != STEPPING:
            life.run()
        state, twin, image = life.save(), life.twin, life.image
        chosen = data.draw(self.draws.inputs)
        values = [data.draw(legal(v)) for v in chosen]
        seen = []
        for player in (life, life, other):
            player.restore(state, twin, image)
            player.set("Real", [v.vr for v in chosen], values)
            for size in sizes:
                player.step(player.twin.time or 0.0, size * self.subject.fmu.step)
            seen.append(replayable(player.image, self.subject.fmu.variables))
        assert seen[0] == seen[1] == seen[2], "a replay went elsewhere"
        assert life.instance.free_state(state) == OK

    @rule(k=which)
    def call_what_is_not_offered(self, k: int) -> None:
        life, room = self.life(k), array("d", [0.0])
        life.unsupported("CancelStep")
        life.unsupported("GetStatus", 0, c_void_p(room.buffer_info()[0]))

    def _forget(self, life: Life) -> None:
        for owner, state, *_ in self.states:
            if owner is life:
                assert life.instance.free_state(state) == OK
        self.states = [entry for entry in self.states if entry[0] is not life]

    def teardown(self) -> None:
        for life in self.lives.values():
            self._forget(life)
            life.free()
