"""What cannot be done is refused in one sentence: nothing changes, `fault` is raised, the next step is discarded."""

from __future__ import annotations

import ctypes
import gc
import math
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from fmu_driver import Instance

from fmukit.runtime.description import TableFile
from fmukit.runtime.table import TableError, read

Make = Callable[[str], Instance]


def _refused(instance: Instance, *words: str) -> None:
    """Exactly one message with these words, a fault, one discarded step, then all is well."""
    assert len(instance.messages) == 1, instance.messages
    for word in words:
        assert word in instance.messages[0]
    assert instance["fault"] == 1
    assert not instance.step(1e-3)
    assert instance["fault"] == 1
    assert instance.step(1e-3)
    assert instance["fault"] == 0


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e4 + 1, -2e4])
def test_value_outside_its_limits(make: Make, value: float) -> None:
    instance = make("DemoSpring").initialise()
    instance.set({"force": 5.0})
    before = instance.outputs()
    instance.set({"force": value})
    assert instance["force"] == 5.0
    assert instance.outputs() == {**before, "fault": 1}
    _refused(instance, "force", "[-10000, 10000] N")


def test_one_bad_value_refuses_the_whole_call(make: Make) -> None:
    instance = make("DemoSpring").initialise()
    references = [instance.variables[name].valueReference for name in ("force", "wind")]
    instance.fmu.setReal(references, [1.0, 2.0])
    instance.fmu.setReal(references, [3.0, math.nan])
    assert list(instance.fmu.getReal(references)) == [1.0, 2.0]
    _refused(instance, "wind")


def test_repeated_calls_are_checked_again(make: Make) -> None:
    instance = make("DemoSpring").initialise()
    for _ in range(3):
        instance.set({"force": 1.0})
        assert instance.step(1e-3)
    instance.set({"force": 1e9})
    _refused(instance, "force = 1000000000.0 N is outside")


def test_parameter_after_initialisation(make: Make) -> None:
    instance = make("DemoSpring").initialise()
    instance.set({"mass": 5.0})
    assert instance["mass"] == 2.0
    _refused(instance, "mass is a fixed parameter")


def test_setting_an_output(make: Make) -> None:
    instance = make("DemoSpring").initialise()
    before = instance["position"]
    instance.set({"position": 5.0})
    assert instance["position"] == before
    _refused(instance, "position is an output")


def test_unknown_and_mistyped_references(make: Make) -> None:
    """Told, and no step suffers: some hosts read every output as a Real one."""
    instance = make("DemoFilter").initialise()
    assert math.isnan(instance.fmu.getReal([999])[0])
    assert "value reference 999" in instance.messages[0]
    assert math.isnan(instance.fmu.getReal([instance.variables["fault"].valueReference])[0])
    assert "fault is of type Boolean" in instance.messages[1]
    assert (len(instance.messages), instance["fault"]) == (2, 0)
    assert instance.step(1e-3)
    instance.fmu.setReal([instance.variables["seed"].valueReference], [1.0])
    instance.messages[:2] = []
    _refused(instance, "seed is of type Integer")


@pytest.mark.parametrize("size", [0.0, -1e-3, math.nan, math.inf, 1e300])
def test_impossible_step(make: Make, size: float) -> None:
    instance = make("DemoSpring").initialise()
    before = instance["position"]
    assert not instance.step(size)
    assert instance["position"] == before
    assert "is not possible" in instance.messages[0]
    assert instance.step(1e-3)


@pytest.mark.parametrize(("model", "parts"), [("DemoSpring", "substeps"), ("DemoFilter", "samples")])
@pytest.mark.parametrize("size", [1e4, 1e5, 1e9])
def test_a_step_of_too_much_work_is_refused_at_once(make: Make, model: str, parts: str, size: float) -> None:
    instance = make(model).initialise()
    before = time.process_time()
    assert not instance.step(size)
    assert time.process_time() - before < 1.0
    assert f"it takes more than 100000 {parts}; take shorter steps" in instance.messages[0]
    assert instance.step(1e-3)
    assert instance.step(10.0), "ten thousand are no work"


def test_step_back_in_time(make: Make) -> None:
    instance = make("DemoSpring").initialise()
    assert instance.step(0.1)
    instance.time = 0.05
    assert not instance.step(1e-3)
    assert "restore an FMU state" in instance.messages[0]


@pytest.mark.parametrize("time", [math.nan, math.inf, -math.inf, 1e13, -1e13])
@pytest.mark.parametrize("model", ["DemoSpring", "DemoFilter"])
def test_first_step_from_an_impossible_time_is_forgotten(make: Make, model: str, time: float) -> None:
    instance = make(model).initialise()
    instance.time = time
    assert not instance.step(5e-3)
    assert "keep the time within" in instance.messages[0]
    instance.time = 0.0
    assert instance.step(5e-3)
    assert instance["fault"] == 0


def test_step_outside_its_states(make: Make) -> None:
    instance = make("DemoSpring")
    assert not instance.step(1e-3)
    assert "initialise first" in instance.messages[0]
    instance.initialise()
    assert instance.step(1e-3)
    instance.fmu.terminate()
    assert not instance.step(1e-3)
    assert "'terminated'" in instance.messages[-1]


def test_step_with_a_result_that_is_not_finite(make: Make) -> None:
    instance = make("DemoFilter").initialise()
    assert instance.step(5e-3)
    before = instance.outputs()
    instance.set({"measured": 77.0})
    assert not instance.step(5e-3)
    assert "quotient is not a finite number" in instance.messages[0]
    assert instance.outputs() == {**before, "fault": 1}
    instance.set({"measured": 78.0})
    assert instance.step(5e-3)
    assert instance["count"] == 2.0


def test_step_of_several_samples_is_done_as_a_whole_or_not_at_all(make: Make) -> None:
    instance = make("DemoFilter").initialise()
    assert instance.step(5e-3)
    before = instance.outputs()
    instance.set({"measured": 1003.0})
    assert not instance.step(25e-3)
    assert "quotient is not a finite number" in instance.messages[0]
    assert instance.outputs() == {**before, "fault": 1}
    instance.set({"measured": 1.0})
    assert instance.step(25e-3)
    assert instance["count"] == before["count"] + 5


def test_null_pointer_is_not_a_text(make: Make) -> None:
    instance = make("DemoFilter").initialise()
    instance.fmu.reset()
    reference = instance.variables["profile_file"].valueReference
    count = len(instance.messages)
    instance.fmu.fmi2SetString(instance.fmu.component, (ctypes.c_uint * 1)(reference), 1, (ctypes.c_char_p * 1)(None))
    assert "null pointer" in instance.messages[count]
    assert instance["profile_file"] in ("", b"")


BAD_TABLES = {
    "missing": (None, "cannot be read (No such file or directory); give the path"),
    "header": ("time,height\n0,1\n1,2\n", "must start with the line time,level"),
    "short": ("time,level\n0,1\n", "must have 2 to 6"),
    "long": ("time,level\n" + "".join(f"{k},1\n" for k in range(7)), "must have 2 to 6"),
    "order": ("time,level\n0,1\n2,1\n1,5\n", "row 4: time must increase"),
    "number": ("time,level\n0,1\n1,x\n", "row 3"),
    "nan": ("time,level\n0,1\n1,nan\n", "row 3"),
    "cells": ("time,level\n0,1\n1\n", "row 3"),
    "binary": (b"\xff\xfe\x00", "cannot be read"),
}


@pytest.mark.parametrize("kind", BAD_TABLES)
def test_bad_table_discards_every_step_until_reset(make: Make, tmp_path: Path, kind: str) -> None:
    content, words = BAD_TABLES[kind]
    file = tmp_path / "100%s.csv"
    if content is not None:
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
    instance = make("DemoFilter").initialise({"profile_file": str(file)})
    assert len(instance.messages) == 1
    assert words in instance.messages[0]
    assert "100%%s.csv" in instance.messages[0]
    assert [instance.step(5e-3) for _ in range(3)] == [False] * 3
    assert instance["fault"] == 1
    instance.fmu.reset()
    assert instance.initialise().step(5e-3)


@pytest.mark.parametrize("header", ["# h_m,t_s", "#h_m, t_s", "h_m,t_s"])
def test_columns_by_other_names_and_in_another_order(tmp_path: Path, header: str) -> None:
    file = tmp_path / "other.csv"
    file.write_text(f"{header}\n5,0\n6,1\n")
    spec = TableFile(0, ("time", "level"), 3, True, (("t_s", "time"), ("h_m", "level")))
    assert read(str(file), spec, Path())[0].tolist() == [0, 5, 1, 6, 1, 6]
    for wrong in ("# h_m,t_s,t_s\n5,0,0\n", "# h_m\n5\n", "# time,depth\n0,5\n"):
        file.write_text(wrong)
        with pytest.raises(TableError, match="must start with the line time,level"):
            read(str(file), spec, Path())


@pytest.mark.skipif(sys.platform == "win32", reason="has neither pipes nor devices among its files")
@pytest.mark.parametrize("kind", ["pipe", "device", "folder"])
def test_table_that_never_ends_is_not_read(make: Make, tmp_path: Path, kind: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    file = {"pipe": tmp_path / "pipe", "device": Path("/dev/zero"), "folder": tmp_path}[kind]
    instance = make("DemoFilter").initialise({"profile_file": str(file)})
    assert "it is not a file" in instance.messages[0]
    assert not instance.step(5e-3)


def test_table_packed_into_the_fmu_is_found_by_its_name(make: Make) -> None:
    """A mere name means the file in the FMU's resources; with a folder it is a file like any other."""
    instance = make("DemoFilter")
    (instance.folder / "resources" / "packed.csv").write_text("time,level\n0,1\n1,x\n")
    instance.initialise({"profile_file": "packed.csv"})
    assert "row 3" in instance.messages[0]
    other = make("DemoFilter").initialise({"profile_file": "./packed.csv"})
    assert "./packed.csv cannot be read" in other.messages[0]


def test_bad_parameter_is_named_and_the_first_step_discarded(make: Make) -> None:
    untouched = make("DemoFilter")["seed"]
    instance = make("DemoFilter").initialise({"time_constant": -1.0, "seed": -5})
    assert "time_constant = -1.0 s is outside" in instance.messages[0]
    assert "seed = -5" in instance.messages[1]
    assert instance["seed"] == untouched
    assert not instance.step(5e-3)
    assert instance.step(5e-3)


def test_faults_and_frees_leave_the_process_whole(make: Make, demo_folder: Path) -> None:
    for _ in range(100):
        instance = Instance(demo_folder / "DemoSpring.fmu", demo_folder / "DemoSpring").initialise()
        instance.set({"force": math.nan, "mass": 1.0})
        instance.step(-1.0)
        instance.fmu.getReal([10**6])
        instance.free()
        gc.collect()
    assert make("DemoSpring").initialise().step(1e-3)
