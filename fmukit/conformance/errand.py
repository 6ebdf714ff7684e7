"""Has an FMU run in a process of its own: `send` starts the process and returns what came out.

The job is a list of tasks, worked off one after the other in the one process (by `bare/__main__.py`): whole lives, of
several instances at once when the task names several FMUs, or the rest of a life from the bytes of an FMU state.
"""

from __future__ import annotations

import json
import secrets
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

from fmukit.conformance.bare import host
from fmukit.guard.ending import death

_READING = 2.0
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

    `bare` runs in a Python without any packages; `peaceful` also asks for an orderly end of the process. There is no
    limit of time here: whoever waits for this process has one.
    """
    command = [sys.executable, *(["-I", "-S"] if bare else []), str(_WORKER)]
    key = secrets.token_hex(16)
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert process.stdin is not None and process.stdout is not None
    lines: list[bytes] = []
    reader = threading.Thread(target=lines.extend, args=(process.stdout,), daemon=True)
    reader.start()
    with suppress(OSError):
        process.stdin.write(json.dumps({"key": key, "tasks": tasks}).encode())
        process.stdin.close()
    code = process.wait()
    reader.join(_READING)
    if not reader.is_alive():  # else what the process left behind holds the pipe open
        process.stdout.close()
    answer = next((found for line in lines if (found := _answer(line, key))), {})
    if "error" in answer:
        raise host.CallFailed(str(answer["error"]))
    if "rows" not in answer:
        raise host.CallFailed(f"a process of its own that ran it {death(code)}")
    if code and peaceful:
        raise host.CallFailed(f"a process that ran it to the end {death(code)} when leaving")
    return [[[tuple(row) for row in rows] for rows in task] for task in answer["rows"]]


def _answer(line: bytes, key: str) -> dict[str, Any]:
    """The answer on a line, {} if it is none: the FMU may have written it."""
    try:
        answer = json.loads(line)
        return answer if isinstance(answer, dict) and answer.get("key") == key else {}
    except (ValueError, RecursionError):
        return {}
