"""A system stepped by hand: the same rows as a run, values and inputs on the way, and what goes wrong."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from cosim_mocks import scenario_of
from small_c import foreign, variable

from cosim.errors import CosimError
from cosim.model.system import System
from cosim.run.request import Request
from cosim.run.running import run
from cosim.simulation import Simulation


@pytest.fixture
def system(tmp_path: Path) -> System:
    """A tank with level' = inflow - outflow, a controller that closes at 2, and a text."""
    ports = [
        variable("level", 0, "output"),
        *(variable(name, k, "input", start="0") for k, name in ((1, "inflow"), (2, "valve"))),
    ]
    tank = foreign(
        tmp_path / "tank.fmu", ports, {"fmi2DoStep": "if (m->r[1] > 90) return 3; m->r[0] += h * (m->r[1] - m->r[2]);"}
    )
    ports = [variable("level", 0, "input", start="0"), variable("valve", 1, "output", variability="discrete")]
    word = variable("word", 2, "output", "String", variability="discrete")
    calls = {"fmi2DoStep": "m->r[1] = m->r[0] >= 2;", "fmi2GetString": 'v[0] = m->r[1] > 0 ? "open" : "shut";'}
    keeper = foreign(tmp_path / "keeper.fmu", [*ports, word], calls)
    made = System()
    made.add("tank", str(tank), period=0.1, kind="continuous")
    made.add("keeper", str(keeper), period=0.2, kind="sampled")
    made.connect("tank", "keeper")
    made.connect("keeper", "tank")
    return made


def test_stepped_it_is_the_run_of_the_command(system: System, tmp_path: Path) -> None:
    system.at(0.3, "tank.inflow", 4.0)
    scenario = scenario_of("tank", lambda _settings, _prepared: system, stop_time=1.0)
    whole = run(Request(scenario, tmp_path / "out")).results
    with Simulation(system, stop_time=1.0) as stepped:
        times = [0.0] * 0
        while stepped.step():
            times.append(stepped.time)
        assert not stepped.step(), "the end stays the end"
        results = stepped.results
    assert times == pytest.approx(np.arange(10) / 10)
    assert results.names == whole.names
    for name in results.names:
        np.testing.assert_array_equal(results[name], whole[name], err_msg=name)
    assert results.table(["tank.level"]).to_pydict()["time"] == pytest.approx(np.arange(11) / 10)
    assert results.table().num_rows == 11


def test_inputs_are_set_on_the_way(system: System) -> None:
    """2 per s from 0.5 s on: the level at the end of the step after it."""
    with Simulation(system, stop_time=2.0) as stepped:
        assert stepped.run_until(0.5) and stepped.time == 0.5 and stepped["tank.level"] == 0.0
        stepped.set("tank.inflow", 2.0)
        seen: list[float] = []
        stepped.watch(lambda simulation: seen.append(simulation["tank.level"]))
        assert stepped.run_until(1.0)
        # the step from 0.5 s had begun without it
        assert seen == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8])
        assert not stepped.run_until(9.0)
        assert stepped.time == 2.0
        assert stepped["keeper.valve"] == (stepped.results["tank.level"][-2] >= 2.0)


def test_wrong_uses_are_told(system: System) -> None:
    with pytest.raises(CosimError, match="a simulation has no realtime; it has assignments"):
        Simulation(system, 1.0, realtime=1.0)
    run = Simulation(system, stop_time=1.0)
    for use in (run.step, lambda: run.set("tank.inflow", 1.0)):
        with pytest.raises(CosimError, match="live in its context"):
            use()
    with run:
        assert len(run.results.time) == 0
        run.step()
        assert run["keeper.word"] == "shut"

        def wrong(_run: Simulation) -> None:
            raise ZeroDivisionError

        run.watch(wrong)
        with pytest.raises(ZeroDivisionError):
            run.step()
        assert not run.step(), "half a tick was done"
    with pytest.raises(CosimError, match="live in its context"):
        run.set("tank.inflow", 1.0)
    with pytest.raises(CosimError, match="runs once"), run:
        pass
    with Simulation(system, stop_time=1.0) as other:
        other.watch(lambda simulation: simulation.step())
        with pytest.raises(CosimError, match="cannot be stepped by its own watcher"):
            other.step()


def test_what_goes_wrong(system: System) -> None:
    with pytest.raises(CosimError, match="a system has no stop time of its own"):
        Simulation(system)
    with (
        pytest.raises(CosimError, match="unknown variable of tank"),
        Simulation(system, 1.0, assignments=[("tank.depth", "1")]),
    ):
        pass
    with Simulation(system, stop_time=1.0) as stepped:
        for signal, sentence in (
            ("tank.valve", "no input that nothing feeds"),
            ("tank.level", "no input that nothing feeds"),
            ("tonk.inflow", "unknown instance"),
        ):
            with pytest.raises(CosimError, match=sentence):
                stepped.set(signal, 1.0)
        with pytest.raises(KeyError, match=r"no signal tank\.depth"):
            stepped["tank.depth"]
        stepped.set("tank.inflow", 99.0)
        with pytest.raises(CosimError, match=r"tank failed at 0 s \(error\)"):
            stepped.run_until(1.0)
        assert not stepped.step()
