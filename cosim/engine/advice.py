"""What FMUs warn of at initialisation, passed on to the user: one line per warning, whoever shares it."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence

from cosim.engine.slave import Slave

_LOG = logging.getLogger("cosim")
_NAMED = 3


def pass_on(slaves: Mapping[str, Slave]) -> None:
    """Log the sentences of the slaves, each once with the names of those that gave it."""
    for text, names in _sentences(slaves).items():
        _LOG.warning("%s: %s", _together(names), text)


def _sentences(slaves: Mapping[str, Slave]) -> dict[str, list[str]]:
    said: dict[str, list[str]] = {}
    for name, slave in slaves.items():
        text = slave.message()
        if text:
            said.setdefault(text, []).append(name)
    return said


def _together(names: Sequence[str]) -> str:
    """The first few by name, then how many more."""
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(names[:_NAMED]) + more
