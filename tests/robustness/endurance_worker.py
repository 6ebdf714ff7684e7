"""`python endurance_worker.py FOLDER CYCLES KIND`: many lives of one FMU in one process; prints what they leave behind.

The lives are all the same and good ("good"), or of all lengths with calls mixed in that are refused ("mixed").

Memory is compared with that after a warm-up, so that what is loaded once does not count.
"""

from __future__ import annotations

import gc
import json
import math
import os
import random
import sys
import tempfile
from collections.abc import Callable
from ctypes import c_void_p
from functools import partial
from pathlib import Path

from raw_fmi import OK, Fmu, Instance

WARM_UP = 100


def left() -> dict[str, int]:
    """What a process can lose: memory in bytes, and numbers of handles, threads, path entries and temporary files."""
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return {
        "memory": pages * os.sysconf("SC_PAGE_SIZE"),
        "handles": len(os.listdir("/proc/self/fd")),
        "threads": len(os.listdir("/proc/self/task")),
        "path": len(sys.path),
        "files": len(os.listdir(tempfile.gettempdir())),
    }


def live(fmu: Fmu, steps: int = 5) -> None:
    instance = fmu.instantiate()
    assert instance.initialise() == OK
    for k in range(steps):
        assert instance.step(k * fmu.step, fmu.step) == OK, instance.messages
    instance.free()


def live_somehow(fmu: Fmu, draw: random.Random) -> None:
    """As long as it happens, with mistakes of the host on the way; whatever it was, it is freed."""
    instance = fmu.instantiate()
    mistakes = _mistakes(fmu, instance)
    stages = draw.randrange(5)
    if draw.random() < 0.5:
        draw.choice(mistakes)()
    if stages:
        instance.initialise()
    for k in range(draw.randrange(6) if stages > 1 else 0):
        if draw.random() < 0.3:
            draw.choice(mistakes)()
        instance.step(k * fmu.step, fmu.step)
    if stages > 2:
        _turn_back(instance)
    if stages > 3:
        instance.call(draw.choice(("Terminate", "Reset")))
    instance.free()


def _mistakes(fmu: Fmu, instance: Instance) -> list[Callable[[], object]]:
    """Calls that are refused, in most states of an instance or in all."""
    output = next(each for each in fmu.variables if (each.causality, each.type) == ("output", "Real"))
    limited = [each for each in fmu.variables if each.causality == "parameter" and each.type == "Real"]
    return [
        lambda: instance.step(0.0, -1.0),
        lambda: instance.step(math.nan, fmu.step),
        lambda: instance.step(0.0, 1e9),
        lambda: instance.set("Real", [output.vr], [1.0]),
        lambda: instance.set("Real", [99999], [1.0]),
        lambda: instance.get("Real", [99999]),
        lambda: instance.set("Real", [limited[0].vr], [math.nan]),
        lambda: instance.call("Terminate"),
        lambda: instance.deserialise(b"no state", c_void_p()),
    ]


def _turn_back(instance: Instance) -> None:
    """Take a state, put it back, through bytes as well."""
    state, other = c_void_p(), c_void_p()
    if instance.get_state(state) == OK:
        status, data = instance.serialise(state)
        if status == OK and instance.deserialise(data, other) == OK:
            instance.set_state(other)
            instance.free_state(other)
        instance.set_state(state)
        instance.free_state(state)


def main(folder: str, cycles: str, kind: str = "good") -> None:
    fmu, first, draw = Fmu(Path(folder)), left(), random.Random(1)
    one = partial(live_somehow, fmu, draw) if kind == "mixed" else partial(live, fmu)
    for _ in range(WARM_UP):
        one()
        gc.collect()
    warm = left()
    for _ in range(int(cycles)):
        one()
        gc.collect()
    last = left()
    grown = {key: last[key] - warm[key] for key in last}
    mapped = str(fmu.folder / "resources") in Path("/proc/self/maps").read_text()
    print(json.dumps({**grown, "path": last["path"] - first["path"], "library": int(mapped)}))


if __name__ == "__main__":
    main(*sys.argv[1:])
