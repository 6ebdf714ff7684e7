"""The six FMI 2.0 models that the FMI project keeps for reference, written anew in C from their published equations.

Each is run by `cosim` and held against a closed form, an independent integration or what its description says.
"""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from cosim_mocks import scenario_of
from scipy.integrate import solve_ivp
from small_c import foreign, variable

from cosim.model.system import System
from cosim.run.request import Request
from cosim.run.running import Finished, run


def experiment(stop: float, step: float) -> str:
    return f'<DefaultExperiment startTime="0" stopTime="{stop}" stepSize="{step}"/>'


def fixed(name: str, reference: int, start: str, kind: str = "Real") -> str:
    return variable(name, reference, "parameter", kind, variability="fixed", initial="exact", start=start)


def ran(
    file: Path, folder: Path, stop: float, prepare: Callable[[System], None] = lambda _system: None, **options: object
) -> Finished:
    system = System()
    system.add("model", str(file), **options)
    prepare(system)
    scenario = scenario_of("reference", lambda _settings, _prepared: system, stop_time=stop)
    return run(Request(scenario, folder))


def test_dahlquist(tmp_path):
    """der(x) = -k x by Euler's method with the communication step: x(n) = (1 - k h)^n, and exp(-k t) to its order."""
    ports = [variable("x", 0, "output", initial="exact", start="1"), fixed("k", 1, "1")]
    begin = "m->r[0] = 1.0; if (m->r[1] == 0.0) m->r[1] = 1.0;"
    calls = {"fmi2EnterInitializationMode": begin, "fmi2DoStep": "m->r[0] -= h * m->r[1] * m->r[0];"}
    file = foreign(tmp_path / "Dahlquist.fmu", ports, calls, experiment=experiment(10, 0.1))
    results = ran(file, tmp_path / "out", 10.0).results
    x = results["model.x"]
    assert len(x) == 101
    np.testing.assert_allclose(x, 0.9 ** np.arange(101), rtol=1e-13)
    errors = []
    for step in (0.1, 0.05, 0.025):
        at_one = ran(file, tmp_path / f"{step}", 1.0, period=step).results["model.x"][-1]
        errors.append(abs(at_one - math.exp(-1.0)))
    assert [errors[k] / errors[k + 1] for k in (0, 1)] == pytest.approx([2.0, 2.0], rel=0.1)
    k = ran(file, tmp_path / "k", 1.0, lambda system: system.set("model.k", "2")).results["model.x"]
    assert k[-1] == pytest.approx(0.8**10, rel=1e-13)


_RK4 = """
  int parts = (int)ceil(h / 1e-3 - 1e-9); double d = h / parts;
  for (int n = 0; n < parts; ++n) {
    double x[2] = {m->r[0], m->r[1]}, k[4][2], y[2];
    const double c[4] = {0, 0.5, 0.5, 1};
    for (int s = 0; s < 4; ++s) {
      for (int j = 0; j < 2; ++j) y[j] = x[j] + (s ? c[s] * d * k[s - 1][j] : 0);
      k[s][0] = y[1];
      k[s][1] = m->r[2] * (1 - y[0] * y[0]) * y[1] - y[0];
    }
    for (int j = 0; j < 2; ++j) m->r[j] = x[j] + d / 6 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]);
  }
"""


@pytest.mark.parametrize("mu", [1.0, 5.0])
def test_van_der_pol(tmp_path, mu):
    """der(x0) = x1, der(x1) = mu (1 - x0^2) x1 - x0, against SciPy's integration."""
    ports = [variable("x0", 0, "output"), variable("x1", 1, "output"), fixed("mu", 2, "1")]
    begin = "if (m->r[2] == 0.0) m->r[2] = 1.0; m->r[0] = 2.0;"
    calls = {"fmi2EnterInitializationMode": begin, "fmi2DoStep": "extern double ceil(double);" + _RK4}
    file = foreign(tmp_path / "VanDerPol.fmu", ports, calls, experiment=experiment(20, 0.01))
    results = ran(file, tmp_path / "out", 20.0, lambda system: system.set("model.mu", f"{mu}")).results

    def slope(_t: float, x: np.ndarray) -> list[float]:
        return [x[1], mu * (1.0 - x[0] ** 2) * x[1] - x[0]]

    exact = solve_ivp(slope, (0.0, 20.0), [2.0, 0.0], "DOP853", results.time, rtol=1e-12, atol=1e-12).y
    assert len(results.time) == 2001
    np.testing.assert_allclose([results["model.x0"], results["model.x1"]], exact, atol=1e-6)


_BALL = """
  int parts = (int)floor(h / 1e-3 + 0.5);
  for (int n = 0; n < parts; ++n) {
    double v = m->r[1];
    m->r[0] += 1e-3 * v;
    m->r[1] += 1e-3 * m->r[2];
    if (m->r[0] <= 0 && m->r[1] < 0) {
      m->r[0] = 2.2250738585072014e-308;
      m->r[1] = -m->r[1] * m->r[3];
      if (m->r[1] < m->r[4]) m->r[1] = m->r[2] = 0;
    }
  }
"""


def bounced(stop: float) -> list[tuple[float, float]]:
    """Height and speed every 10 ms, by the published scheme."""
    h, v, g = 1.0, 0.0, -9.81
    rows = [(h, v)]
    for k in range(1, round(stop * 1000) + 1):
        h, v = h + 1e-3 * v, v + 1e-3 * g
        if h <= 0.0 and v < 0.0:
            h, v = 2.2250738585072014e-308, -v * 0.7
            if v < 0.1:
                v = g = 0.0
        if k % 10 == 0:
            rows.append((h, v))
    return rows


def test_bouncing_ball(tmp_path):
    """Falls from 1 m, loses three tenths of its speed at every bounce, and lies still below 0.1 m/s."""
    ports = [variable("h", 0, "output"), variable("v", 1, "output")]
    begin = "m->r[0] = 1.0; m->r[2] = -9.81; m->r[3] = 0.7; m->r[4] = 0.1;"
    calls = {"fmi2EnterInitializationMode": begin, "fmi2DoStep": "extern double floor(double);" + _BALL}
    file = foreign(tmp_path / "BouncingBall.fmu", ports, calls, experiment=experiment(3, 0.01))
    results = ran(file, tmp_path / "out", 3.0).results
    h, v = results["model.h"], results["model.v"]
    np.testing.assert_allclose(np.transpose([h, v]), bounced(3.0), atol=1e-12)
    impact = math.sqrt(2.0 / 9.81)
    flying = results.time < impact
    np.testing.assert_allclose(h[flying], 1.0 - 0.5 * 9.81 * results.time[flying] ** 2, atol=5e-3)
    second = results.time[int(np.argmax(v > 1.0)) :]
    assert second[0] == pytest.approx(impact, abs=0.02)
    assert max(h[results.time > impact + 0.02]) == pytest.approx(0.49, abs=0.02), "0.7 squared"
    assert (h[-1], v[-1]) == (pytest.approx(0.0, abs=1e-12), 0.0)
    assert (h >= 0.0).all()


def test_feedthrough(tmp_path):
    """Every type comes out as it went in, in its own type in the results."""
    kinds = {"real": "Real", "integer": "Integer", "boolean": "Boolean", "enumeration": "Enumeration"}
    items = "".join(f'<Item name="Option {k}" value="{k}"/>' for k in (1, 2))
    option = f'<SimpleType name="Option"><Enumeration>{items}</Enumeration></SimpleType>'
    starts = {"real": "0", "integer": "0", "boolean": "false", "enumeration": "1", "string": "Set me!"}
    discrete = {"variability": "discrete"}
    more = {"enumeration": {"declaredType": "Option"}}
    ports = []
    for place, (name, kind) in enumerate([*kinds.items(), ("string", "String")]):
        declared = more.get(name, {}) | ({} if name == "real" else discrete)
        ports.append(variable(f"{name}_input", place, "input", kind, start=starts[name], **declared))
        ports.append(variable(f"{name}_output", place + 8, "output", kind, **declared))
    calls = {
        "fmi2EnterInitializationMode": "m->i[3] = m->i[3] ? m->i[3] : 1;",
        "fmi2GetReal": "for (size_t i = 0; i < n; ++i) v[i] = m->r[vr[i] & 7];",
        "fmi2GetInteger": "for (size_t i = 0; i < n; ++i) v[i] = m->i[vr[i] & 7];",
        "fmi2GetBoolean": "for (size_t i = 0; i < n; ++i) v[i] = m->i[vr[i] & 7];",
        "fmi2SetString": 'snprintf(m->name, sizeof m->name, "%s", v[0]); m->i[14] = 1;',
        "fmi2GetString": 'v[0] = m->i[14] ? m->name : "Set me!";',
    }
    file = foreign(tmp_path / "Feedthrough.fmu", ports, calls, types=option, experiment=experiment(2, 0.1))

    def prepare(system: System) -> None:
        for time, values in (
            (0.5, ("1.5", "2147483647", "true", "Option 2", "Größe")),
            (1.0, ("-2", "-7", "0", "1", "")),
        ):
            for name, value in zip([*kinds, "string"], values, strict=True):
                system.at(time, f"model.{name}_input", value)

    results = ran(file, tmp_path / "out", 2.0, prepare, kind="sampled").results
    at = [int(np.argmin(abs(results.time - time))) for time in (0.2, 0.7, 1.5)]
    assert results["model.real_output"][at].tolist() == [0.0, 1.5, -2.0]
    assert results["model.integer_output"][at].tolist() == [0, 2147483647, -7]
    assert results["model.boolean_output"][at].tolist() == [False, True, False]
    assert results["model.enumeration_output"][at].tolist() == [1, 2, 1]
    assert results["model.string_output"][at].tolist() == ["Set me!", "Größe", ""]
    kept = [results[f"model.{name}_output"].dtype for name in kinds]
    assert kept == ["float64", "int32", "bool", "int32"]


def test_resource(tmp_path):
    """The first letter of a file among its resources, wherever it is unpacked."""
    ports = [variable("y", 0, "output", "Integer", variability="discrete")]
    read = """char path[1100]; snprintf(path, sizeof path, "%s/y.txt", m->where);
      FILE *file = fopen(path, "r"); if (!file) return 3; m->i[0] = fgetc(file); fclose(file);"""
    calls = {"fmi2EnterInitializationMode": read}
    options = {"experiment": experiment(1, 0.1), "resources": {"y.txt": b"a"}}
    file = foreign(tmp_path / "Resource.fmu", ports, calls, **options)
    finished = ran(file, tmp_path / "out", 1.0)
    assert finished.summary.status == "ok"
    assert finished.results["model.y"].tolist() == [97] * len(finished.results.time)


def test_stair(tmp_path):
    """Counts the seconds from 1 to 10, and then asks for the end of the simulation."""
    ports = [variable("counter", 0, "output", "Integer", variability="discrete")]
    calls = {
        "fmi2EnterInitializationMode": "m->i[0] = 1;",
        "fmi2DoStep": "if (m->i[0] >= 10) return 2; m->i[0] = 1 + (int)(t + h + 1e-9);",
        "fmi2GetBooleanStatus": "*v = k == 3 && m->i[0] >= 10;",
    }
    file = foreign(tmp_path / "Stair.fmu", ports, calls, experiment=experiment(10, 0.2))
    finished = ran(file, tmp_path / "out", 10.0, kind="continuous")
    assert (finished.summary.status, finished.summary.reason) == ("ok", "model ended the simulation at 9 s")
    results = finished.results
    assert results["model.counter"].dtype == "int32"
    assert results["model.counter"].tolist() == [1 + math.floor(time + 1e-9) for time in results.time]
    assert results["model.counter"][-1] == 10
