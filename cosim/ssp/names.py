"""Names of files in an archive, the URIs that refer to them, and names that every tool takes."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable
from urllib.parse import quote

_UNSAFE = re.compile(r"[^A-Za-z0-9_.-]|^\.+|\.+$")


def free_name(stem: str, suffix: str, taken: Container[str]) -> str:
    """`stem` + `suffix`, numbered where a file of that name is `taken` (in lower case: some systems tell no case).

    Characters that lead out of a folder, that some system forbids, or that a URI has to escape become underscores: Ecos
    resolves no escapes.
    """
    plain = _UNSAFE.sub("_", stem) or "_"
    name, number = plain + suffix, 1
    while name.casefold() in taken:
        number += 1
        name = f"{plain}-{number}{suffix}"
    return name


def uri(member: str) -> str:
    """The URI reference of a member of the archive, relative to its root (RFC 3986, as SSP 1.0 asks of `source`)."""
    return quote(member)


def identifiers(names: Iterable[str]) -> dict[str, str]:
    """An identifier for each name, all different: OMSimulator takes no dots and hyphens in names of elements."""
    found: dict[str, str] = {}
    for name in names:
        plain = re.sub(r"[^A-Za-z0-9_]", "_", name)
        plain = plain if re.match(r"[A-Za-z]", plain) else f"x{plain}"
        made, number = plain, 1
        while made in found.values():
            number += 1
            made = f"{plain}_{number}"
        found[name] = made
    return found
