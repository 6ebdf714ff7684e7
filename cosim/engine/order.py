"""What is done at a tick, in which order: some of it before the row is recorded, the rest after it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cosim.engine.slave import do_nothing

Action = Callable[[], object]


class Order:
    """The actions of a tick; `actions` are all of them in order, the recording of the row between the two parts."""

    __slots__ = ("_after", "_before", "_record", "actions")

    def __init__(self, before: Sequence[Action], record: Action, after: Sequence[Action]) -> None:
        self._before, self._record, self._after = tuple(before), record, tuple(after)
        self.actions = [*before, record, *after]

    def framed(self, first: Sequence[Action], after_record: Sequence[Action] = ()) -> Order:
        """The same with actions before all others, and with some just after the row."""
        return Order([*first, *self._before], self._record, [*after_record, *self._after])


def both(one: Action, other: Action) -> Action:
    """One action that does both, one after the other."""
    if other is do_nothing:
        return one
    if one is do_nothing:
        return other

    def act() -> None:
        one()
        other()

    return act


Tick = tuple[int, Order]
"""The time [ns] and what is done then."""
