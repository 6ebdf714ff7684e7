"""Zip archives that depend on nothing but their members: the same bytes from the same contents, on every machine."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping

_STAMP = (1980, 1, 1, 0, 0, 0)
_MODE = 0o100644 << 16


def pack(members: Mapping[str, bytes]) -> bytes:
    """The archive of the members by name, in the order of their names; modelDescription.xml, if any, comes first."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for name in sorted(members, key=lambda name: (name != "modelDescription.xml", name)):
            item = zipfile.ZipInfo(name, _STAMP)
            item.create_system, item.external_attr, item.compress_type = 3, _MODE, zipfile.ZIP_DEFLATED
            archive.writestr(item, members[name])
    return buffer.getvalue()
