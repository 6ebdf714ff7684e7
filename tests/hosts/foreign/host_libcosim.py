"""libcosim, the C++ master of the Open Simulation Platform: fixed step, all instances together."""

from __future__ import annotations

from host_job import Job, serve, typed
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave


def run(job: Job) -> list[list[float]]:
    step = round(job["step"] * 1e9)
    execution = CosimExecution.from_ssp_file(job["ssp"], step) if "ssp" in job else assembled(job, step)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    indices = {info.name.decode(): info.index for info in execution.slave_infos()}
    references: dict[str, list[int]] = {}
    for instance, _, reference in job["signals"]:
        references.setdefault(instance, []).append(reference)
    found = []
    for _ in range(job["steps"] // job["every"]):
        assert execution.step(job["every"])
        values = (observer.last_real_values(indices[name], refs) for name, refs in references.items())
        found.append([value for part in values for value in part])
    return found


def assembled(job: Job, step: int) -> CosimExecution:
    execution = CosimExecution.from_step_size(step)
    indices = {
        name: execution.add_local_slave(CosimLocalSlave(instance["fmu"], name))
        for name, instance in job["instances"].items()
    }
    for source, _, output, target, _, input_ in job["connections"]:
        assert execution.connect_real_variables(indices[source], output, indices[target], input_) == 0
    setters = {
        "Real": execution.real_initial_value,
        "Integer": execution.integer_initial_value,
        "Boolean": execution.boolean_initial_value,
        "String": execution.string_initial_value,
    }
    for name, instance in job["instances"].items():
        for kind, value, reference in instance["values"].values():
            assert setters[kind](indices[name], reference, typed(kind, value))
    return execution


serve(run)
