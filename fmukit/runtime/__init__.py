"""The one slave every FMU embeds, unchanged. Standard library and pythonfmu only, and relative imports only.

Inside an FMU this package lies in a package whose name carries the hash of the FMU's contents, beside
`interface.json` (read by `description`) and the compiled kernel (called by `library`). The script PythonFMU
executes takes the slave class from there and hands its globals to `keep`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .description import Description
from .slave import EmbeddedSlave

_KEPT: list[dict[str, Any]] = []


def keep(script_globals: dict[str, Any]) -> None:
    """Own one reference to the script's globals: PythonFMU releases them once too often per instantiation."""
    _KEPT.append(script_globals)


def slave_class(folder: Path) -> type[EmbeddedSlave]:
    """The slave class of the FMU whose interface lies in `folder`."""
    description = Description.read(folder / "interface.json")
    return type(description.name, (EmbeddedSlave,), {"description_": description, "package": folder.name})
