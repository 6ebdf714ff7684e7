"""What a user types of values, events and periods."""

from __future__ import annotations

import math
from collections.abc import Iterable

from cosim.errors import CosimError


def parse_assignments(texts: Iterable[str]) -> list[tuple[str, str]]:
    """[("llc.suspension.enabled", "false")] from ["llc.suspension.enabled=false"]."""
    pairs = []
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or "." not in name.strip():
            raise CosimError(f"cannot read {text!r}; write --set instance.variable=value")
        pairs.append((name.strip(), value.strip()))
    return pairs


def parse_periods(texts: Iterable[str]) -> list[tuple[str, float]]:
    """[("car*", 0.01)] from ["car*=0.01"]."""
    periods = []
    for text in texts:
        name, _, value = text.rpartition("=")
        try:
            seconds = float(value)
        except ValueError:
            seconds = math.nan
        if not name.strip() or math.isnan(seconds):
            raise CosimError(f"cannot read {text!r}; write --period instance=seconds")
        periods.append((name.strip(), seconds))
    return periods


def parse_events(texts: Iterable[str]) -> list[tuple[float, str, str]]:
    """[(3.0, "mpc.motor_available.rr", "0")] from ["3.0:mpc.motor_available.rr=0"]."""
    events = []
    for text in texts:
        time, colon, assignment = text.partition(":")
        name, equals, value = assignment.partition("=")
        try:
            seconds = float(time)
        except ValueError:
            colon = ""
        if not (colon and equals) or "." not in name.strip():
            raise CosimError(f"cannot read {text!r}; write --at time:instance.variable=value with the time in seconds")
        events.append((seconds, name.strip(), value.strip()))
    return events
