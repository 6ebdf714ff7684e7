"""`python exit_worker.py FOLDER...`: load, run and free or abandon several FMUs through FMPy, then end the process."""

from __future__ import annotations

import sys
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave


def main(folders: list[str]) -> None:
    for k, folder in enumerate(folders):
        about = fmpy.read_model_description(folder)
        name = about.coSimulation.modelIdentifier
        fmu = FMU2Slave(guid=about.guid, unzipDirectory=folder, modelIdentifier=name, instanceName=name)
        fmu.instantiate()
        fmu.setupExperiment(startTime=0.0)
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        fmu.doStep(0.0, float(about.defaultExperiment.stepSize))
        if k % 2:
            fmu.terminate()
            fmu.freeInstance()
    print("done", len(folders), Path(folders[0]).name)


if __name__ == "__main__":
    main(sys.argv[1:])
