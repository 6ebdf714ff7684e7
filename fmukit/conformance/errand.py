"""Runs FMUs in a process of its own: `send` starts it, this file run as a script does it.

The job is a list of tasks, worked off one after the other in the one process: whole lives (of several instances at
once, in turns, when the task names several FMUs), or the rest of a life from the bytes of an FMU state.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parent))
    import host  # type: ignore[import-not-found]
else:
    from fmukit.conformance import host

TIMEOUT = 30.0


def lives(runs: list[tuple[host.Target, host.Plan]]) -> dict[str, Any]:
    """A task: whole lives at the same time, in turns."""
    return {"runs": [{"target": vars(target), "plan": vars(plan)} for target, plan in runs]}


def rest(target: host.Target, plan: host.Plan, data: bytes, first: int) -> dict[str, Any]:
    """A task: the steps from number `first` on, after restoring `data`."""
    return {"runs": [{"target": vars(target), "plan": vars(plan)}], "state": data.hex(), "first": first}


def send(tasks: list[dict[str, Any]], bare: bool = False, peaceful: bool = False) -> list[list[list[host.Row]]]:
    """The outputs of each run of each task; raises CallFailed.

    `bare` runs in a Python without any packages; `peaceful` also asks for an orderly end of the process.
    """
    command = [sys.executable, *(["-I", "-S"] if bare else []), str(Path(__file__).resolve())]
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
    import signal  # noqa: PLC0415  (needed in the worst case only)

    try:
        return f"was killed by signal {-code} ({signal.strsignal(-code)})"
    except ValueError:
        return f"was killed by signal {-code}"


def _work(task: dict[str, Any]) -> list[list[Any]]:
    pairs = [(_target(run["target"]), _plan(run["plan"])) for run in task["runs"]]
    instances = [host.made(target, f"instance{k}") for k, (target, _) in enumerate(pairs)]
    if "state" in task:
        return [_resume(instances[0], pairs[0][1], bytes.fromhex(task["state"]), task["first"])]
    seen = [[host.initialised(instance, plan)] for instance, (_, plan) in zip(instances, pairs, strict=True)]
    for k in range(max(len(plan.rows) for _, plan in pairs)):
        for rows, instance, (_, plan) in zip(seen, instances, pairs, strict=True):
            rows.extend(host.steps(instance, host.Plan(plan.start, plan.step, plan.rows[: k + 1]), k))
    for instance in instances:
        instance.must("Terminate")
        instance.free()
    return seen


def _resume(instance: Any, plan: Any, data: bytes, first: int) -> list[Any]:
    status, state = instance.from_bytes(data)
    instance.expect("fmi2DeSerializeFMUstate in a new process", status)
    instance.restore(state)
    seen = host.steps(instance, plan, first)
    instance.forget(state)
    instance.free()
    return list(seen)


def _target(raw: dict[str, Any]) -> Any:
    outputs = tuple((type_, tuple(references)) for type_, references in raw["outputs"])
    return host.Target(raw["library"], raw["resources"], raw["guid"], tuple(raw["inputs"]), outputs)


def _plan(raw: dict[str, Any]) -> Any:
    return host.Plan(raw["start"], raw["step"], tuple(tuple(row) for row in raw["rows"]))


def _main() -> None:
    """Answer on the standard output, to which nothing the FMU prints may go."""
    answer_to = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    try:
        answer: dict[str, Any] = {"rows": [_work(task) for task in json.load(sys.stdin)]}
    except host.CallFailed as error:
        answer = {"error": str(error)}
    json.dump(answer, answer_to, default=lambda value: value.decode("utf-8", "replace"))
    answer_to.close()


if __name__ == "__main__":
    _main()
