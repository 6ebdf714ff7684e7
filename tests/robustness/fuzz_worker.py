"""`python fuzz_worker.py FOLDER SEQUENCES SEED JOURNAL`: fuzz the FMU unzipped in FOLDER, in a process of its own.

Prints what was done as JSON. The journal holds the calls of the present sequence, the last one being the one that was
under way: it tells how a process died that could not tell it itself.
"""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path

from fuzz_life import Subject
from fuzz_machine import machine
from hypothesis import HealthCheck, Phase, seed, settings
from hypothesis.stateful import run_state_machine_as_test
from raw_fmi import Fmu


def main(folder: str, sequences: str, chosen: str, journal: str) -> None:
    file = os.open(journal, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    subject = Subject(Fmu(Path(folder)), file)
    chosen_settings = settings(
        max_examples=int(sequences),
        stateful_step_count=20,
        deadline=None,
        database=None,
        phases=[Phase.generate, Phase.shrink],
        suppress_health_check=list(HealthCheck),
        report_multiple_bugs=False,
    )
    start = time.perf_counter()
    run_state_machine_as_test(seed(int(chosen))(machine(subject)), settings=chosen_settings)
    seconds = time.perf_counter() - start
    print(json.dumps({"calls": subject.calls, "seconds": round(seconds, 2), **subject.counts}))


if __name__ == "__main__":
    main(*sys.argv[1:])
