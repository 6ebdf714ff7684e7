"""An FMU with two quadratic programs: the bits of its kernel in this process, whoever else is solving."""

from __future__ import annotations

import ctypes
import math
import re
import threading
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import casadi as ca
import demo_programs
import pe_file
import pytest
from fmu_driver import Instance

from fmukit.compiling import compiler
from fmukit.conformance.pytest_helper import assert_conformant
from fmukit.direct import Direct
from fmukit.interface import Interface
from fmukit.kernel import sampled_kernel
from fmukit.packaging.builder import build, library
from fmukit.packaging.codegen import generate
from fmukit.qp import QpSettings, codegen

SIZE = demo_programs.STEP
_BAD = {"poison": (3, 11), "crossed": (4, 11), "impossible": (5, 6)}


def _inputs(k: int, shift: float = 0.0) -> dict[str, float]:
    """Sample k: targets that move, and samples whose problems are useless in each way."""
    values = {"sum": 3.0 * math.sin(0.7 * k + shift), "target": math.cos(0.2 * k + shift)}
    return values | {name: float(k in samples) for name, samples in _BAD.items()}


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build(demo_programs.COMPONENT, tmp_path_factory.mktemp("programs"))


@pytest.fixture
def instances(path: Path) -> Iterator[list[Instance]]:
    made = [Instance(path, path.parent / "unpacked", f"instance{i}").initialise() for i in range(2)]
    yield made
    for instance in made:
        instance.free()


def _run(instance: Instance, samples: range, shift: float = 0.0) -> list[dict[str, float]]:
    seen = []
    for k in samples:
        instance.set(_inputs(k, shift))
        assert instance.step(SIZE), instance.messages
        seen.append(instance.outputs())
    return seen


def _direct(count: int, shift: float = 0.0) -> list[dict[str, float]]:
    reference = Direct(demo_programs.COMPONENT)
    seen = []
    for k in range(count):
        reference.set(_inputs(k, shift))
        reference.sample()
        seen.append({**reference.outputs(), "fault": 0.0})
    return seen


def test_fmu_and_direct_give_the_same_bits(instances: list[Instance]) -> None:
    seen = _run(instances[0], range(40))
    assert seen == _direct(40)
    assert {outputs["plan.status"] for outputs in seen} == {1.0, 3.0, -1.0, -2.0}
    assert {outputs["spread.status"] for outputs in seen} == {1.0, -1.0, -2.0}
    assert len({outputs["plan.rho"] for outputs in seen}) > 2
    assert {outputs["plan.time"] for outputs in seen} == {0.0}


def test_two_instances_in_turn_equal_each_alone(instances: list[Instance]) -> None:
    together: list[list[dict[str, float]]] = [[], []]
    for k in range(25):
        for i, instance in enumerate(instances):
            together[i] += _run(instance, range(k, k + 1), shift=float(i))
    assert together == [_direct(25, float(i)) for i in range(2)]


def test_two_threads_driving_two_instances_equal_each_alone(instances: list[Instance]) -> None:
    seen: list[list[dict[str, float]]] = [[], []]

    def run(which: int) -> None:
        seen[which] = _run(instances[which], range(60), float(which))

    threads = [threading.Thread(target=run, args=(which,)) for which in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert seen == [_direct(60, float(which)) for which in range(2)]


def test_a_state_replays_here_and_in_another_instance(instances: list[Instance]) -> None:
    one, other = instances
    _run(one, range(8))
    state, time = one.fmu.getFMUstate(), one.time
    data = one.fmu.serializeFMUstate(state)
    first = _run(one, range(8, 20))
    one.fmu.setFMUstate(state)
    one.time = time
    assert _run(one, range(8, 20)) == first
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(data))
    other.time = time
    assert _run(other, range(8, 20)) == first


def test_time_is_measured_when_asked_for(path: Path) -> None:
    instance = Instance(path, path.parent / "unpacked", "timed").initialise({"solver.timed": True})
    assert all(0.0 < seen["plan.time"] < 1.0 for seen in _run(instance, range(3)))
    instance.free()


def test_it_obeys_the_reading_rules(path: Path) -> None:
    assert_conformant(path, "AX", strict=True)


@pytest.mark.nightly
def test_it_obeys_every_rule(path: Path) -> None:
    assert_conformant(path, strict=True)


def test_it_carries_the_licence_and_notice_of_osqp(path: Path) -> None:
    with zipfile.ZipFile(path) as archive:
        text = archive.read("documentation/licenses/osqp.txt").decode()
    assert "Apache License" in text
    assert "Copyright (c) 2019 Bartolomeo Stellato, Goran Banjac, Paul Goulart, Stephen Boyd" in text
    assert "Copyright (c) 2018, Paul Goulart" in text


def test_builds_are_identical(path: Path, tmp_path: Path) -> None:
    assert build(demo_programs.COMPONENT, tmp_path / "another/place").read_bytes() == path.read_bytes()


def test_library_shows_the_kernel_only(path: Path, tmp_path: Path) -> None:
    code = generate(demo_programs.INTERFACE, demo_programs.kernel())
    file = tmp_path / compiler.PLATFORMS[compiler.host_platform()]
    file.write_bytes(library(code, compiler.host_platform()))
    kernel = ctypes.CDLL(str(file))
    assert hasattr(kernel, "fmukit_sample")
    for hidden in ("qp_spread", "qp_plan", "qp_node", "osqp_solve", "QDLDL_factor"):
        assert not hasattr(kernel, hidden)


@pytest.mark.nightly
def test_windows_library_shows_the_kernel_only() -> None:
    pytest.importorskip("ziglang", reason="needs the extra zig")
    found = pe_file.read(library(generate(demo_programs.INTERFACE, demo_programs.kernel()), "win64"))
    assert set(found.exports) == {f"fmukit_{n}" for n in ("initialise", "normals", "sample", "size", "store")}


def test_generated_code_holds_no_place_no_time_and_no_numbers() -> None:
    solver, settings = demo_programs.solvers()[1], QpSettings(absolute=1e-5, relative=0.0)
    assert codegen.sources("qp_plan", *_patterns(), settings) == solver.sources
    assert codegen.sources("qp_plan", *_patterns(), replace(settings, alpha=1.5)) != solver.sources
    text = solver.sources["qp_plan_osqp_workspace.c"]
    assert "autogenerated" not in text
    assert "/tmp" not in text
    assert re.findall(r"OSQPFloat\s+(\w+)\[\d+\] = ", text) == ["qp_plan_osqp_linsys_KKT_x"]


def _patterns() -> tuple[ca.Sparsity, ca.Sparsity]:
    parts = demo_programs.plan_problem(ca.MX.zeros(2), ca.MX(0), ca.MX(0), ca.MX(0))
    return parts[0].sparsity(), parts[2].sparsity()


def test_a_solver_that_is_called_must_be_given() -> None:
    interface = Interface("Lone", "no solver given", "sampled", 1.0, demo_programs.INTERFACE.variables)
    given = demo_programs.solvers()
    assembled = partial(
        sampled_kernel,
        interface,
        states=demo_programs.STATES,
        initialise=lambda: ({}, {}, {}),
        sample=partial(demo_programs.sample, given),
        symbol=ca.MX,
    )
    with pytest.raises(ValueError, match=r"Lone: solvers given twice \[], called but not given \['qp_plan'\]"):
        assembled(solvers=given[:1])
    with pytest.raises(ValueError, match=r"given twice \['qp_spread'\]"):
        assembled(solvers=[*given, given[0]])
