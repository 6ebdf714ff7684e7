"""Patterns such as car*.llc.filter.speed: the instances that fit, and which of them have the variable."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from fnmatch import fnmatchcase

from cosim.errors import CosimError, unknown

Given = tuple[str, str, str]
"""A pattern, an instance that fits, and the variable it names."""


def is_pattern(text: str) -> bool:
    """Whether `text` has a character that stands for others."""
    return bool({"*", "?"} & set(text))


def fitting(pattern: str, instances: Iterable[str]) -> list[tuple[str, str]]:
    """(instance, variable) of all instances whose name fits the beginning of `pattern`, the longest names."""
    parts = pattern.split(".")
    found: dict[int, list[tuple[str, str]]] = {}
    for name in instances:
        own = name.split(".")
        head, variable = parts[: len(own)], ".".join(parts[len(own) :])
        if variable and all(fnmatchcase(part, wanted) for part, wanted in zip(own, head, strict=True)):
            found.setdefault(len(own), []).append((name, variable))
    if not found:
        raise CosimError(
            f"no instance fits the pattern {pattern!r}; * and ? stand for characters between two dots, "
            "as in car*.llc.filter.speed, and `--explain` lists the instances"
        )
    return found[max(found)]


def lacking(given: Iterable[Given], known: Mapping[str, Collection[str]], kind: str, look: str) -> set[Given]:
    """Those of `given` whose instance has no such variable among the `known` of it.

    Raises CosimError for a pattern none of whose instances has it; `kind` of variable, `look` says where they are.
    """
    given = set(given)
    absent = {each for each in given if each[2] not in known[each[1]]}
    for pattern in sorted({each[0] for each in absent} - {each[0] for each in given - absent}):
        fit = [(instance, variable) for of, instance, variable in given if of == pattern]
        raise unknown(
            f"{kind} of the instances that fit {pattern!r}", fit[0][1], {n for i, _ in fit for n in known[i]}, look
        )
    return absent
