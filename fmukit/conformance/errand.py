"""Has an FMU run in a process of its own: `send` starts the process and returns what came out.

The job is a list of tasks, worked off one after the other in the one process (by `bare/__main__.py`): whole lives, of
several instances at once when the task names several FMUs, or the rest of a life from the bytes of an FMU state.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

from fmukit.conformance.bare import host

TIMEOUT = 30.0
_WORKER = Path(host.__file__).parent
Task = dict[str, Any]


def lives(runs: list[tuple[host.Target, host.Experiment]]) -> Task:
    """A task: whole lives at the same time, in turns."""
    return {"runs": [{"target": vars(target), "experiment": vars(experiment)} for target, experiment in runs]}


def rest(target: host.Target, experiment: host.Experiment, data: bytes, first: int) -> Task:
    """A task: the steps from number `first` on, after restoring `data`."""
    return {**lives([(target, experiment)]), "state": data.hex(), "first": first}


def send(tasks: list[Task], bare: bool = False, peaceful: bool = False) -> list[list[list[host.Row]]]:
    """The outputs of each run of each task; raises CallFailed.

    `bare` runs in a Python without any packages; `peaceful` also asks for an orderly end of the process.
    """
    command = [sys.executable, *(["-I", "-S"] if bare else []), str(_WORKER)]
    try:
        done = subprocess.run(
            command, check=False, input=json.dumps(tasks).encode(), capture_output=True, timeout=TIMEOUT
        )
    except subprocess.TimeoutExpired:
        raise host.CallFailed(f"a process of its own that runs it did not end within {TIMEOUT:g} s") from None
    answer = json.loads(done.stdout) if done.stdout else {}
    if "error" in answer:
        raise host.CallFailed(str(answer["error"]))
    if "rows" not in answer:
        raise host.CallFailed(f"a process of its own that ran it {death(done.returncode)}")
    if done.returncode and peaceful:
        raise host.CallFailed(f"a process that ran it to the end {death(done.returncode)} when leaving")
    return [[[tuple(row) for row in rows] for rows in task] for task in answer["rows"]]


def death(code: int) -> str:
    """How a process ended, in words: 'was killed by signal 11 (Segmentation fault)'."""
    if code >= 0:
        return f"ended with status {code}"
    try:
        return f"was killed by signal {-code} ({signal.strsignal(-code)})"
    except ValueError:
        return f"was killed by signal {-code}"
