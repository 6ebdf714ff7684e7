"""`python faults_worker.py FOLDER CYCLES`: fault and free an FMU in FMPy over and over; prints the messages seen."""

from __future__ import annotations

import gc
import math
import sys

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave


def discarded(fmu: FMU2Slave, time: float, size: float) -> bool:
    try:
        fmu.doStep(time, size)
    except FMICallException as error:
        return bool(error.status == 2)
    return False


def fault(folder: str, about: fmpy.model_description.ModelDescription, cycle: int) -> None:
    """One life with every kind of fault; freed in the state the cycle's number chooses."""
    name, step = about.coSimulation.modelIdentifier, float(about.defaultExperiment.stepSize)
    fmu = FMU2Slave(guid=about.guid, unzipDirectory=folder, modelIdentifier=name, instanceName=f"{name}{cycle}")
    fmu.instantiate()
    assert discarded(fmu, 0.0, step)
    if cycle % 4:
        fmu.setupExperiment(startTime=0.0)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        fmu.enterInitializationMode()
        assert discarded(fmu, 0.0, step)
        for variable in about.modelVariables:
            if variable.causality == "input" and variable.type == "Real":
                fmu.setReal([variable.valueReference], [math.nan])
        assert discarded(fmu, 0.0, step) or not any(v.causality == "input" for v in about.modelVariables)
        assert math.isnan(fmu.getReal([10**6])[0])
        fmu.setReal([10**6], [1.0])
        assert discarded(fmu, step, step)
        assert all(discarded(fmu, step, size) for size in (0.0, -step, math.nan, math.inf))
        fmu.doStep(step, step)
    if cycle % 4 == 2:
        fmu.terminate()
        assert discarded(fmu, 2 * step, step)
    if cycle % 4 == 3:
        fmu.reset()
    fmu.freeInstance()


def main(folder: str, cycles: str) -> None:
    about = fmpy.read_model_description(folder)
    gc.collect()
    gc.freeze()  # what was loaded until now need not be searched every time
    for cycle in range(int(cycles)):
        fault(folder, about, cycle)
        gc.collect()
    print("done", cycles)


if __name__ == "__main__":
    main(*sys.argv[1:])
