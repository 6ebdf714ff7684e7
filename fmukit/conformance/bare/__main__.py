"""Works off the tasks of an errand: whole lives of instances, or the rest of a life from the bytes of an FMU state.

The job is a list of tasks on the standard input, worked off one after the other in this one process. A task with
several runs has their instances alive at the same time, in turns. See `fmukit.conformance.errand`, which sends it.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

# This folder is run as it is, in a Python that may not find fmukit.
import host  # type: ignore[import-not-found]
import pulse  # type: ignore[import-not-found]


def _work(task: dict[str, Any]) -> list[list[Any]]:
    """The outputs of each run of the task."""
    pairs = [(_target(run["target"]), _experiment(run["experiment"])) for run in task["runs"]]
    instances = [host.made(target, f"instance{k}") for k, (target, _) in enumerate(pairs)]
    experiments = [experiment for _, experiment in pairs]
    if "state" in task:
        return [_resume(instances[0], experiments[0], bytes.fromhex(task["state"]), task["first"])]
    return _in_turns(instances, experiments)


def _in_turns(instances: list[Any], experiments: list[Any]) -> list[list[Any]]:
    together = list(zip(instances, experiments, strict=True))
    seen = [[host.initialised(instance, experiment)] for instance, experiment in together]
    for k in range(max(len(experiment.rows) for experiment in experiments)):
        for rows, (instance, experiment) in zip(seen, together, strict=True):
            rows.extend(host.steps(instance, experiment.until(k + 1), k))
    for instance in instances:
        instance.must("Terminate")
        instance.free()
    return seen


def _resume(instance: Any, experiment: Any, data: bytes, first: int) -> list[Any]:
    status, state = instance.from_bytes(data)
    instance.expect("fmi2DeSerializeFMUstate in a new process", status)
    instance.restore(state)
    seen = host.steps(instance, experiment, first)
    instance.forget(state)
    instance.free()
    return list(seen)


def _target(raw: dict[str, Any]) -> Any:
    outputs = tuple((type_, tuple(references)) for type_, references in raw["outputs"])
    return host.Target(raw["library"], raw["resources"], raw["guid"], tuple(raw["inputs"]), outputs)


def _experiment(raw: dict[str, Any]) -> Any:
    return host.Experiment(raw["start"], raw["step"], tuple(tuple(row) for row in raw["rows"]))


def _main() -> None:
    """Answer on a line of its own, with the key of the job, where the FMU does not print."""
    job = json.load(sys.stdin)
    answer_to = os.dup(1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(2, 1)
    beat = pulse.own()
    if beat is not None:
        host.ears.append(beat.beat)
    try:
        answer: dict[str, Any] = {"rows": [_work(task) for task in job["tasks"]]}
    except host.CallFailed as error:
        answer = {"error": str(error)}
    text = json.dumps({"key": job["key"], **answer}, default=lambda value: value.decode("utf-8", "replace"))
    with os.fdopen(answer_to, "w") as stream:
        stream.write(f"\n{text}\n")


_main()
