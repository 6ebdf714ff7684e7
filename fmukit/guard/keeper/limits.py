"""What a guarded process may use."""

from __future__ import annotations

import sys
from dataclasses import dataclass

MIB = 1 << 20
_PLENTY = 4096 * MIB
_ROOM = 1024


@dataclass(frozen=True)
class Limits:
    """Bounds on a command and all its descendants; a field of None is no bound.

    `memory` [bytes] is what all of them may hold together, `address_space` [bytes] what each may reserve, `file`
    [bytes] how large each file may grow, `processes` how many there may be at once and `descriptors` how many each may
    have open. `interval` [s] is how often they are counted. Core files are never written.

    The operating system can bound the processes of a user only, not those of a command, so that bound is a wide one and
    the keeper counts; it does not hold for root.
    """

    memory: int | None = _PLENTY
    address_space: int | None = 16 * _PLENTY
    file: int | None = 1024 * MIB
    processes: int | None = 64
    descriptors: int | None = 1024
    interval: float = 0.05


def apply(limits: Limits, threads: int = 0) -> None:
    """Put the bounds the operating system knows upon this process and those it will start; nothing on Windows.

    `threads` is how many there are on the system now; 0 leaves the number of processes to the keeper.
    """
    if sys.platform == "win32":
        return
    import resource  # noqa: PLC0415  (there is none on Windows)

    bounds = {"AS": limits.address_space, "FSIZE": limits.file, "NOFILE": limits.descriptors, "CORE": 0}
    if threads and limits.processes is not None:
        bounds["NPROC"] = threads + limits.processes + _ROOM
    for name, bound in bounds.items():
        kind = getattr(resource, f"RLIMIT_{name}")
        _, hard = resource.getrlimit(kind)
        if bound is not None:
            most = bound if hard == resource.RLIM_INFINITY else min(bound, hard)
            resource.setrlimit(kind, (most, most))
