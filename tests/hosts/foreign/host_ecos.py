"""Ecos, whose master is written in C++: all instances step, then values move along the connections."""

from __future__ import annotations

from ecospy import EcosLib, EcosSimulation, EcosSimulationStructure
from host_job import Job, serve, typed


def run(job: Job) -> list[list[float]]:
    EcosLib.set_log_level("warn")
    if "ssp" in job:
        with EcosSimulation(ssp_path=job["ssp"], step_size=job["step"]) as simulation:
            return rows(simulation, job)
    with EcosSimulationStructure() as system:
        for name, instance in job["instances"].items():
            system.add_model(name, instance["fmu"])
        for source, output, _, target, input_, _ in job["connections"]:
            system.make_real_connection(f"{source}::{output}", f"{target}::{input_}")
        system.add_parameter_set("parameters", parameters(job))
        with EcosSimulation(structure=system, step_size=job["step"]) as simulation:
            return rows(simulation, job)


def parameters(job: Job) -> dict[str, object]:
    return {
        f"{name}::{variable}": typed(kind, value)
        for name, instance in job["instances"].items()
        for variable, (kind, value, _) in instance["values"].items()
    }


def rows(simulation: EcosSimulation, job: Job) -> list[list[float]]:
    assert simulation.init(parameter_set="parameters"), EcosLib.get_last_error()
    names = [f"{instance}::{output}" for instance, output, _ in job["signals"]]
    found = []
    for _ in range(job["steps"] // job["every"]):
        simulation.step(job["every"])
        found.append([simulation.get_real(name) for name in names])
    simulation.terminate()
    return found


serve(run)
