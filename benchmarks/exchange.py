"""What one exchange of an FMU (set all inputs, step, get all outputs) costs beside a PythonFMU that does nothing.

The reference is an ordinary PythonFMU slave with the same Real ports, attributes and an empty `do_step`, made by
PythonFMU's own builder. Both are called alike, through raw ctypes with preallocated buffers, alternately in one run.
"""

from __future__ import annotations

import ctypes
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.model_description import ModelDescription
from pythonfmu.builder import FmuBuilder

ROUNDS = 25
_CALLS = 400

_HEAD = """from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class {name}(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        for i in range({inputs}):
            setattr(self, f"input{{i}}", 0.0)
            self.register_variable(Real(f"input{{i}}", causality=Fmi2Causality.input))
        for i in range({outputs}):
            setattr(self, f"output{{i}}", 0.0)
            self.register_variable(Real(f"output{{i}}", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        return True
"""


def measure(path: Path, step: float = 1e-3, rounds: int = ROUNDS) -> dict[str, float]:
    """Median microseconds per exchange of the FMU at `path` (`exchange`) and of its empty twin (`reference`).

    `ratio` is the median of the ratios of neighbouring rounds; `inputs` and `outputs` count the Real ports.
    """
    description = fmpy.read_model_description(str(path))
    inputs, outputs = _ports(description, "input"), _ports(description, "output")
    with tempfile.TemporaryDirectory() as name:
        twin = _twin(Path(name), f"Twin{description.modelName}", len(inputs), len(outputs))
        rounds = _alternate(_exchange(path, step), _exchange(twin, step), rounds)
    own, reference = [pair[0] for pair in rounds], [pair[1] for pair in rounds]
    return {
        "inputs": len(inputs),
        "outputs": len(outputs),
        "exchange": median(own),
        "reference": median(reference),
        "ratio": median(a / b for a, b in rounds),
    }


def _alternate(one: Callable[[int], None], other: Callable[[int], None], rounds: int) -> list[tuple[float, float]]:
    """Microseconds per exchange of both, round by round; the first two rounds warm up."""
    return [(_time(one), _time(other)) for _ in range(rounds + 2)][2:]


def _time(exchange: Callable[[int], None]) -> float:
    start = time.perf_counter()
    exchange(_CALLS)
    return (time.perf_counter() - start) / _CALLS * 1e6


def _ports(description: ModelDescription, causality: str) -> list[int]:
    return [v.valueReference for v in description.modelVariables if (v.causality, v.type) == (causality, "Real")]


def _twin(folder: Path, name: str, inputs: int, outputs: int) -> Path:
    script = folder / f"{name.lower()}.py"
    script.write_text(_HEAD.format(name=name, inputs=inputs, outputs=outputs), "utf-8")
    before = list(sys.path)
    try:
        return Path(FmuBuilder.build_FMU(script, dest=folder))
    finally:
        sys.path[:] = before
        sys.modules.pop(name.lower(), None)


def _exchange(path: Path, step: float) -> Callable[[int], None]:
    """Instantiate and initialise the FMU; the returned function makes a number of exchanges at the start values."""
    description = fmpy.read_model_description(str(path))
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=fmpy.extract(str(path)),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="benchmark",
    )
    fmu.instantiate()
    fmu.setupExperiment()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    inputs, outputs = _references(_ports(description, "input")), _references(_ports(description, "output"))
    taken, given = (ctypes.c_double * len(inputs))(), (ctypes.c_double * len(outputs))()
    get, set_, do_step = _raw(fmu, "fmi2GetReal"), _raw(fmu, "fmi2SetReal"), _raw(fmu, "fmi2DoStep")
    get(fmu.component, inputs, len(inputs), taken)
    component, n, m = fmu.component, len(inputs), len(outputs)
    clock = [0]

    def exchange(count: int) -> None:
        for _ in range(count):
            status = set_(component, inputs, n, taken)
            status += do_step(component, clock[0] * step, step, 1)
            status += get(component, outputs, m, given)
            if status:
                raise RuntimeError(f"{description.modelName} failed at {clock[0] * step} s")
            clock[0] += 1

    return exchange


def _raw(fmu: FMU2Slave, name: str) -> Callable[..., int]:
    """The C function without FMPy's wrapper around it."""
    function: Any = getattr(ctypes.CDLL(fmu.dll._name), name)
    function.restype = ctypes.c_int
    function.argtypes = {
        "fmi2DoStep": [ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int],
    }.get(name, [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p])
    raw: Callable[..., int] = function
    return raw


def _references(numbers: Sequence[int]) -> ctypes.Array[ctypes.c_uint]:
    return (ctypes.c_uint * len(numbers))(*numbers)


if __name__ == "__main__":
    for argument in sys.argv[1:]:
        print(argument, measure(Path(argument)))
