"""Small FMUs made with plain PythonFMU, and scenarios and models offered as an installed package would."""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType

import pytest
from pythonfmu.builder import FmuBuilder

from cosim.engine import models
from cosim.scenario import discovery
from cosim.scenario.definition import Scenario

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


@pytest.fixture
def offer(monkeypatch: pytest.MonkeyPatch) -> Callable[[Scenario, dict[str, Path]], None]:
    """offer(scenario, {"Tank": file}): from now on an installed package offers this scenario and these models."""

    def offered(scenario: Scenario, files: dict[str, Path]) -> None:
        module = ModuleType("offered_by_a_test")
        module.SCENARIO, module.names, module.file = scenario, lambda: list(files), files.__getitem__  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, module.__name__, module)
        more = [
            EntryPoint(scenario.name, f"{module.__name__}:SCENARIO", discovery.GROUP),
            EntryPoint("test", module.__name__, models.GROUP),
        ]

        def found(*, group: str) -> list[EntryPoint]:
            return [*entry_points(group=group), *(entry for entry in more if entry.group == group)]

        monkeypatch.setattr(discovery, "entry_points", found)
        monkeypatch.setattr(models, "entry_points", found)

    return offered
