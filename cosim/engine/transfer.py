"""Values that are not Real, taken and given by a call per type, beside the Real ones that go by pointer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from ctypes import c_char_p, c_int
from typing import Any

from cosim.engine.slave import OK, WARNING, Call
from cosim.model.signals import Vector

Arguments = tuple[Any, ...]
"""Of a C function, before its values: the instance, the value references and their number."""


def get_whole_numbers(function: Any, arguments: Arguments, values: Vector) -> Call:
    """Integers, Enumerations or Booleans into `values`, as doubles."""
    memory = (c_int * len(values))()

    def get() -> int:
        status = int(function(*arguments, memory))
        values[:] = memory
        return status

    return get


def set_whole_numbers(function: Any, arguments: Arguments, values: Vector) -> Call:
    """Integers, Enumerations or Booleans from `values`, the nearest whole numbers."""
    memory = (c_int * len(values))()

    def set_() -> int:
        memory[:] = [round(value) for value in values.tolist()]
        return int(function(*arguments, memory))

    return set_


def get_texts(function: Any, arguments: Arguments, values: list[str]) -> Call:
    """Strings into `values`; what is no UTF-8 is replaced, as FMI 2.0 allows nothing else."""
    memory = (c_char_p * len(values))()

    def get() -> int:
        status = int(function(*arguments, memory))
        if status <= WARNING:
            values[:] = [(text or b"").decode("utf-8", "replace") for text in memory]
        return status

    return get


def set_texts(function: Any, arguments: Arguments, values: list[str]) -> Call:
    """Strings from `values`."""
    memory = (c_char_p * len(values))()

    def set_() -> int:
        memory[:] = [text.encode() for text in values]
        return int(function(*arguments, memory))

    return set_


def in_turn(calls: Sequence[Callable[[], int]]) -> Call:
    """Makes the calls until one fails; the worst status."""

    def call() -> int:
        worst = OK
        for each in calls:
            worst = max(worst, each())
            if worst > WARNING:
                break
        return worst

    return calls[0] if len(calls) == 1 else call
