"""`python endurance_worker.py FOLDER CYCLES`: many lives of one FMU in one process; prints what each leaves behind.

Memory is compared with that after a warm-up, so that what is loaded once does not count.
"""

from __future__ import annotations

import gc
import json
import os
import sys
import tempfile
from pathlib import Path

from raw_fmi import OK, Fmu

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


def main(folder: str, cycles: str) -> None:
    fmu, first = Fmu(Path(folder)), left()
    for _ in range(WARM_UP):
        live(fmu)
        gc.collect()
    warm = left()
    for _ in range(int(cycles)):
        live(fmu)
        gc.collect()
    last = left()
    grown = {key: last[key] - warm[key] for key in last}
    mapped = str(fmu.folder / "resources") in Path("/proc/self/maps").read_text()
    print(json.dumps({**grown, "path": last["path"] - first["path"], "library": int(mapped)}))


if __name__ == "__main__":
    main(*sys.argv[1:])
