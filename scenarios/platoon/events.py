"""What disturbs a platoon, and when. Light to import."""

from __future__ import annotations

from typing import NamedTuple


class Span(NamedTuple):
    """When [s] an event begins and has died out."""

    begin: float
    end: float


END = 80.0
"""The end of the run [s]."""
_TOGETHER = {"push": Span(4.0, 16.0), "merge": Span(16.0, 46.0), "braking": Span(46.0, 78.0)}
_ALONE = {
    "push": Span(4.0, 16.0),
    "braking": Span(8.0, 40.0),
    "merge": Span(4.0, 34.0),
    "sweep": Span(0.0, END),
}
"""All events in one run, and each alone."""
MANOEUVRES = ("events", *_ALONE, "quiet")


def spans(manoeuvre: str) -> dict[str, Span]:
    """The events of the manoeuvre by name; of "quiet" there are none."""
    if manoeuvre == "events":
        return dict(_TOGETHER)
    return {name: span for name, span in _ALONE.items() if name == manoeuvre}


def changes_until(manoeuvre: str) -> float:
    """Up to when [s] places in the platoon change: the end of the merge, whether there is one or not."""
    return (_TOGETHER if manoeuvre == "events" else _ALONE)["merge"].end
