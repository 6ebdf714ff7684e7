"""Small FMUs made with plain PythonFMU, for tests of the loader and the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
from pythonfmu.builder import FmuBuilder

_TANK = """
from pythonfmu import Fmi2Causality, Fmi2Initial, Fmi2Slave, Fmi2Variability, Integer, Real, String
from pythonfmu.enums import Fmi2Status

_KEEP = []


class {name}(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        _KEEP.append(globals())
        self.inflow, self.level, self.fail_at, self.seed = 0.0, 1.0, 1e9, 1
        fixed = dict(causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed)
        self.register_variable(Real("inflow", causality=Fmi2Causality.input))
        self.register_variable(Real("fail_at", **fixed))
        self.register_variable(Integer("seed", **fixed))
        self.register_variable(
            Real("level", causality=Fmi2Causality.output, initial=Fmi2Initial.calculated,
                 variability=Fmi2Variability.continuous)
        )

    def do_step(self, time, step):
        if time + step > self.fail_at:
            self.log("the tank leaks 100%s of its water", Fmi2Status.discard)
            return False
        self.level += step * (self.inflow - self.level)
        return True
"""


@pytest.fixture(scope="session")
def tank(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """level' = inflow - level, Euler; discards from the parameter fail_at [s] on, with a % in its message."""
    folder = tmp_path_factory.mktemp("fmu")
    script = folder / "cosim_test_tank.py"
    script.write_text(_TANK.format(name="CosimTestTank"))
    return Path(FmuBuilder.build_FMU(script, dest=folder))
