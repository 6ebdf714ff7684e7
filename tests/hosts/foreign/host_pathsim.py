"""pathsim-fmi: one FMU as a block of PathSim.

It takes every port for a Real one and gives inputs without a connection the value 0. Hence the two additions a user
needs too: only Real ports are shown to it, and inputs that start elsewhere get a constant.
"""

from __future__ import annotations

from typing import Any

import pathsim_fmi.blocks as fmi
from host_job import Job, serve, typed
from pathsim import Connection, Simulation
from pathsim.blocks import Constant


class RealPorts(fmi.FMUWrapper):  # type: ignore[misc]
    def _build_variable_maps(self) -> None:
        super()._build_variable_maps()
        for references in (self.input_refs, self.output_refs):
            for name in [name for name in references if self.variable_map[name].type != "Real"]:
                del references[name]


fmi.FMUWrapper = RealPorts


def run(job: Job) -> list[list[float]]:
    ((name, instance),) = job["instances"].items()
    values = {variable: typed(kind, value) for variable, (kind, value, _) in instance["values"].items()}
    block = fmi.CoSimulationFMU(instance["fmu"], instance_name=name, start_values=values, dt=job["step"])
    constants = {port: Constant(start) for port, start in starts(block).items() if start}
    wires = [Connection(constant, block[port]) for port, constant in constants.items()]
    simulation = Simulation([block, *constants.values()], wires, dt=job["step"], log=False)
    places = [list(block.fmu_wrapper.output_refs).index(output) for _, output, _ in job["signals"]]
    found = []
    for _ in range(job["steps"]):
        simulation.timestep(job["step"], adaptive=False)
        found.append([float(block.outputs.to_array()[place]) for place in places])
    return found[job["every"] - 1 :: job["every"]]


def starts(block: Any) -> dict[str, float]:
    variables = block.fmu_wrapper.variable_map
    return {name: float(variables[name].start) for name in block.fmu_wrapper.input_refs}


serve(run)
