"""Names of files in an archive, and the URIs that refer to them."""

from __future__ import annotations

import re
from collections.abc import Container
from urllib.parse import quote

_UNSAFE = re.compile(r"[^\w.+#%@=,()\[\] -]|^\.+|\.+$")


def free_name(stem: str, suffix: str, taken: Container[str]) -> str:
    """`stem` + `suffix`, numbered where a file of that name is `taken` (in lower case: some systems tell no case).

    Characters that lead out of a folder or that some system forbids become underscores.
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
