"""OMSimulator 3 with its Python interface: fixed step, all FMUs together. It only opens SSPs here."""

from __future__ import annotations

from host_job import Job, serve
from OMSimulator import SSP, CRef


def run(job: Job) -> list[list[float]]:
    package = SSP(job["ssp"])
    system = package.activeVariant.system.name
    model = package.instantiate()
    model.setFixedStepSize(job["step"])
    model.setStopTime(job["step"] * job["steps"])
    model.initialize()
    found = []
    for row in range(1, job["steps"] // job["every"] + 1):
        model.stepUntil(row * job["every"] * job["step"])
        found.append([model.getValue(CRef(system, instance, output)) for instance, output, _ in job["signals"]])
    model.terminate()
    model.delete()
    return found


serve(run)
