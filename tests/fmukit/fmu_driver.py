"""Drive one FMU instance by variable names through FMPy, collecting its messages."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path

import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)


def _nothing(*_: object) -> None:
    """Stands for the memory callbacks, which PythonFMU does not use."""


class Instance:
    """An instantiated FMU; unzipped into `folder` unless it was before."""

    def __init__(self, path: Path, folder: Path, name: str = "instance") -> None:
        if not folder.exists():
            fmpy.extract(str(path), str(folder))
        self.folder = folder
        self.description = fmpy.read_model_description(str(path))
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.messages: list[str] = []
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
        self._callbacks.allocateMemory = fmi2CallbackAllocateMemoryTYPE(_nothing)
        self._callbacks.freeMemory = fmi2CallbackFreeMemoryTYPE(_nothing)
        self.fmu = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.fmu.instantiate(callbacks=self._callbacks, loggingOn=True)
        self.time = 0.0

    def _log(self, environment: object, name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.messages.append(message.decode())

    def initialise(self, values: Mapping[str, object] | None = None, start: float = 0.0) -> Instance:
        self.fmu.setupExperiment(startTime=start)
        self.set(values or {})
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = start
        return self

    def set(self, values: Mapping[str, object]) -> None:
        for name, value in values.items():
            variable = self.variables[name]
            getattr(self.fmu, f"set{variable.type}")([variable.valueReference], [value])

    def __getitem__(self, name: str) -> float:
        variable = self.variables[name]
        (value,) = getattr(self.fmu, f"get{variable.type}")([variable.valueReference])
        return value

    def outputs(self) -> dict[str, float]:
        return {name: self[name] for name, v in self.variables.items() if v.causality == "output"}

    def step(self, size: float) -> bool:
        """Whether the step was done; time goes on only then."""
        try:
            self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=size)
        except FMICallException:
            return False
        self.time += size
        return True

    def play(self, script: Sequence[Mapping[str, object]], size: float) -> list[dict[str, float]]:
        """The outputs after each step of `size` [s], before which the values of the script are set."""
        seen = []
        for values in script:
            self.set(values)
            assert self.step(size), self.messages
            seen.append(self.outputs())
        return seen

    def free(self, remove: bool = False) -> None:
        self.fmu.freeInstance()
        if remove:
            shutil.rmtree(self.folder)
