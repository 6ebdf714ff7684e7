"""Outputs that are not Real: fetched by a call per type and put beside the Real ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import c_char_p, c_int
from typing import Any

from cosim.engine.slave import OK, WARNING, Call
from cosim.model.signals import Vector


def whole_numbers(function: Any, arguments: tuple[Any, ...], values: Vector) -> Call:
    """Integers, Enumerations or Booleans into `values`, as doubles."""
    memory = (c_int * len(values))()

    def get() -> int:
        status = int(function(*arguments, memory))
        values[:] = memory
        return status

    return get


def texts(function: Any, arguments: tuple[Any, ...], values: list[str]) -> Call:
    """Strings into `values`; what is no UTF-8 is replaced, as FMI 2.0 allows nothing else."""
    memory = (c_char_p * len(values))()

    def get() -> int:
        status = int(function(*arguments, memory))
        if status <= WARNING:
            values[:] = [(text or b"").decode("utf-8", "replace") for text in memory]
        return status

    return get


def first_failure(calls: Sequence[Callable[[], int]]) -> int:
    """Make the calls until one fails; the worst status."""
    worst = OK
    for call in calls:
        worst = max(worst, call())
        if worst > WARNING:
            break
    return worst
