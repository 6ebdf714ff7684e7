"""What a foreign host is asked to do, as JSON, and how a host program takes and answers it.

A job steps `instances` (file, and values by name as [type, value, value reference]) with `connections` [[instance,
output, reference, instance, input, reference], ...] together at `step` [s], `steps` times, and gives the `signals`
[[instance, output, value reference], ...] after every `every`-th step. With `ssp` the system comes from that file.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

Job = dict[str, Any]
_TYPES: dict[str, Callable[[Any], Any]] = {"Real": float, "Integer": int, "Boolean": bool, "String": str}


def typed(kind: str, value: Any) -> Any:
    """The value as the Python type of an FMI type: hosts tell types apart by it."""
    return _TYPES[kind](value)


def serve(run: Callable[[Job], list[list[float]]]) -> None:
    """`python HOST.py jobs.json out.npz`: run the jobs one after the other in this process."""
    jobs = json.loads(Path(sys.argv[1]).read_text())
    np.savez(sys.argv[2], **{name: np.array(run(job)) for name, job in jobs.items()})
