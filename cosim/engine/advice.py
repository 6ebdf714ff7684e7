"""What FMUs warn of, passed on to the user: one line per warning, whoever shares it."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence

from cosim.engine.slave import Slave

_LOG = logging.getLogger("cosim")
_NAMED = 3


def pass_on(slaves: Mapping[str, Slave], before: Mapping[str, str] | None = None, but: str = "") -> dict[str, str]:
    """Log the last sentence of each slave but those said `before`, once with the names of those that gave it.

    What is told anyway, in the sentence `but`, is left out. Returns the sentences by slave.
    """
    last = {name: slave.message() for name, slave in slaves.items()}
    said: dict[str, list[str]] = {}
    for name, text in last.items():
        if text and text != (before or {}).get(name) and text.rstrip(". ") not in but:
            said.setdefault(text, []).append(name)
    for text, names in said.items():
        _LOG.warning("%s: %s", _together(names), text)
    return last


def _together(names: Sequence[str]) -> str:
    """The first few by name, then how many more."""
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more
