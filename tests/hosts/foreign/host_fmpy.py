"""FMPy's simulate_fmu: one FMU, with validation."""

from __future__ import annotations

from fmpy import simulate_fmu
from host_job import Job, serve, typed


def run(job: Job) -> list[list[float]]:
    ((_, instance),) = job["instances"].items()
    names = [output for _, output, _ in job["signals"]]
    result = simulate_fmu(
        instance["fmu"],
        stop_time=job["step"] * job["steps"],
        output_interval=job["step"],
        start_values={name: typed(kind, value) for name, (kind, value, _) in instance["values"].items()},
        output=names,
    )
    assert len(result) == job["steps"] + 1
    return [[float(row[name]) for name in names] for row in result][job["every"] :: job["every"]]


serve(run)
