"""Integers, Booleans, Enumerations and Strings travel from FMU to FMU, and lookups change them on their way."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from cosim_mocks import scenario_of
from small_c import foreign, variable

from cosim.errors import CosimError
from cosim.model.system import System
from cosim.model.transformation import Lookup, Transformation
from cosim.model.units import Conversion
from cosim.run.request import Request
from cosim.run.running import Finished, run

MODE = '<SimpleType name="Mode"><Enumeration><Item name="off" value="1"/><Item name="on" value="2"/></Enumeration>'
MODES = f"{MODE}</SimpleType>"
COUNTING = "m->steps++; m->i[1] = m->steps; m->i[2] = m->steps % 2; m->i[3] = 1 + m->steps % 2;"
SAYING = 'static char said[32]; sprintf(said, "%d steps", m->steps); v[0] = said;'
KINDS = [("i", 1, "Integer"), ("b", 2, "Boolean"), ("e", 3, "Enumeration"), ("s", 4, "String")]


def ports(causality: str, offset: int = 0) -> list[str]:
    """One variable of each type; their attributes are those their types want."""
    kept = {"Integer": "0", "Boolean": "false", "Enumeration": "1", "String": ""}
    more = {"Enumeration": {"declaredType": "Mode"}}
    return [
        variable(
            name if causality == "input" else f"{name}",
            reference + offset,
            causality,
            kind,
            variability="discrete",
            **({"start": kept[kind]} if causality == "input" else {}),
            **more.get(kind, {}),
        )
        for name, reference, kind in KINDS
    ]


@pytest.fixture
def chain(tmp_path: Path) -> System:
    """A counter, and one that puts out what it takes: the texts through a static buffer."""
    x = variable("x", 0, "output")
    counter = foreign(
        tmp_path / "counter.fmu",
        [x, *ports("output")],
        {"fmi2DoStep": f"m->r[0] += h; {COUNTING}", "fmi2GetString": SAYING},
        types=MODES,
    )
    echoes = [text.replace('name="', 'name="echo_') for text in ports("output", 4)]
    echo = foreign(
        tmp_path / "echo.fmu",
        [variable("x", 0, "input", start="0"), *ports("input"), *echoes, variable("echo_x", 1, "output")],
        {
            "fmi2DoStep": "for (int k = 1; k < 4; ++k) m->i[k + 4] = m->i[k]; m->r[1] = m->r[0];",
            "fmi2SetString": 'snprintf(m->name, sizeof m->name, "%s", v[0]);',
            "fmi2GetString": "v[0] = m->name;",
        },
        types=MODES,
    )
    system = System()
    system.add("counter", str(counter), period=0.1, kind="sampled")
    system.add("echo", str(echo), period=0.1, kind="sampled")
    return system


def ran(system: System, folder: Path, scheme: str = "multirate", isolate: tuple[str, ...] = ()) -> Finished:
    scenario = scenario_of("typed", lambda _settings, _prepared: system, stop_time=0.5)
    return run(Request(scenario, folder, scheme=scheme, isolate=isolate))


@pytest.mark.parametrize("isolate", ["counter", "echo", "all"])
def test_every_type_is_carried_from_process_to_process(chain: System, tmp_path: Path, isolate: str) -> None:
    chain.connect("counter", "echo")
    for name, isolated in (("plain", ()), ("isolated", (isolate,))):
        assert ran(chain, tmp_path / name, isolate=isolated).summary.status == "ok"
    files = [(tmp_path / name / "results.parquet").read_bytes() for name in ("plain", "isolated")]
    assert files[0] == files[1]


@pytest.mark.parametrize(("scheme", "late"), [("multirate", 0), ("jacobi", 1)])
def test_every_type_is_carried(chain: System, tmp_path: Path, scheme: str, late: int) -> None:
    """In order at once, in parallel a step later; what is said by one buffer of all calls is copied in time."""
    chain.connect("counter", "echo")
    results = ran(chain, tmp_path / "out", scheme).results
    for name in "xibe":
        source, target = results[f"counter.{name}"], results[f"echo.echo_{name}"]
        np.testing.assert_array_equal(target[1:], source[1 - late : len(source) - late])
    count = results["counter.i"].astype(int)
    np.testing.assert_array_equal(count[:-1], np.arange(5) + 1 - late)
    texts = _texts(tmp_path / "out")
    assert texts["echo.echo_s"][1 + late :] == [f"{n} steps" for n in count[1 : len(count) - late]]


def _texts(folder: Path) -> dict[str, list[str]]:
    import pyarrow.parquet as pq  # noqa: PLC0415

    table = pq.read_table(folder / "results.parquet")
    return {name: table[name].to_pylist() for name in table.column_names if name.endswith("_s")}


def test_lookups_and_steps(chain: System, tmp_path: Path) -> None:
    """An Enumeration by a list, an Integer three times as large, a Boolean turned round."""
    chain.link(("counter", "e"), ("echo", "e"), Transformation((Lookup(((1, 2), (2, 1))),)))
    chain.link(("counter", "i"), ("echo", "i"), Transformation((Conversion(3.0, 1.0),)))
    chain.link(("counter", "b"), ("echo", "b"), Transformation((Lookup(((0, 1), (1, 0))),)))
    results = ran(chain, tmp_path / "out").results
    assert results["echo.echo_e"][:-1] == pytest.approx(3 - results["counter.e"][:-1])
    assert results["echo.echo_i"][:-1] == pytest.approx(3 * results["counter.i"][:-1] + 1)
    assert results["echo.echo_b"][:-1] == pytest.approx(1 - results["counter.b"][:-1])


def test_a_value_without_an_entry_ends_the_run(chain: System, tmp_path: Path) -> None:
    chain.link(("counter", "i"), ("echo", "i"), Transformation((Lookup(tuple((k, k) for k in range(4))),)))
    finished = ran(chain, tmp_path / "out")
    assert finished.summary.status == "failed"
    assert finished.summary.reason == ("echo failed at 0.3 s (error): counter.i -> echo.i has no entry for the value 4")


@pytest.mark.parametrize(
    ("output", "input_", "sentence"),
    [
        ("b", "i", r"counter\.b -> echo\.i: one is Boolean, the other Integer; connect ports of one type"),
        ("x", "i", "one is Real, the other Integer"),
        ("s", "x", "one is String, the other Real"),
        ("y", "x", "unknown output of counter"),
        ("x", "y", "unknown input of echo"),
    ],
)
def test_what_does_not_fit(chain: System, tmp_path: Path, output: str, input_: str, sentence: str) -> None:
    chain.link(("counter", output), ("echo", input_))
    with pytest.raises(CosimError, match=sentence):
        ran(chain, tmp_path / "out")


def test_integers_are_numbers(chain: System, tmp_path: Path) -> None:
    chain.link(("counter", "i"), ("echo", "x"))
    chain.link(("counter", "e"), ("echo", "i"))
    results = ran(chain, tmp_path / "out").results
    np.testing.assert_array_equal(results["echo.echo_x"][:-1], results["counter.i"][:-1])
    np.testing.assert_array_equal(results["echo.echo_i"][:-1], results["counter.e"][:-1])


def test_steps_in_a_row_become_one() -> None:
    made = Transformation().then(Conversion(2.0, 1.0)).then(Conversion()).then(Conversion(3.0, -1.0))
    assert made.steps == (Conversion(6.0, 2.0),) and made(5.0) == 3 * (2 * 5 + 1) - 1
    looked_up = made.then(Lookup(((32, 1),)))
    assert looked_up(5.0) == 1.0 and looked_up.linear is None
