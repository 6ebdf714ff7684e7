"""Kernel libraries: what they need and show on each platform, and that Windows' gives the numbers of Linux'.

Zig compiles a platform's C runtime once, which takes minutes; so what needs the ziglang package runs nightly.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path

import demo_filter
import demo_programs
import demo_spring
import numpy as np
import pe_file
import pytest

from fmukit.compiling import compiler
from fmukit.component import Component
from fmukit.packaging.builder import build, library
from fmukit.packaging.codegen import generate
from fmukit.python_kernel import PythonKernel
from fmus import CATALOGUE

ALWAYS = {"fmukit_normals", "fmukit_size", "fmukit_store"}
SYSTEM = ("kernel32.dll", "msvcrt.dll", "ucrtbase.dll")
WINE = shutil.which("wine") or shutil.which("wine64") or shutil.which("/usr/lib/wine/wine64")

needs_zig = pytest.mark.skipif(find_spec("ziglang") is None, reason="needs the extra zig")
needs_wine = pytest.mark.skipif(WINE is None, reason="needs Wine (Debian's wine64)")


def _compiled(component: Component, platform: str) -> bytes:
    return library(generate(component.interface, component.kernel()), platform)


def _needed(data: bytes, folder: Path) -> set[str]:
    (folder / "kernel.so").write_bytes(data)
    done = subprocess.run(
        ["readelf", "-d", folder / "kernel.so"], capture_output=True, text=True, check=True, env={"LC_ALL": "C"}
    )
    return {line.partition("[")[2].rstrip("]") for line in done.stdout.splitlines() if "(NEEDED)" in line}


@pytest.fixture
def zig_everywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    """As on a machine without a compiler of its own."""
    monkeypatch.setattr(compiler, "native", lambda: None)
    monkeypatch.setattr(compiler, "command", compiler.command.__wrapped__)


@pytest.mark.skipif(shutil.which("readelf") is None or sys.platform == "win32", reason="needs readelf")
@pytest.mark.parametrize("component", [CATALOGUE[0], demo_filter.COMPONENT], ids=lambda c: c.interface.name)
def test_linux_library_needs_only_the_c_library(component: Component, tmp_path: Path) -> None:
    needed = _needed(_compiled(component, "linux64"), tmp_path)
    assert needed
    assert needed <= {"libc.so.6", "libm.so.6"}


def test_what_is_no_windows_library_is_told() -> None:
    with pytest.raises(ValueError, match="no DOS header"):
        pe_file.read(b"\x7fELF" + bytes(100))


@pytest.mark.nightly
@needs_zig
@pytest.mark.parametrize("component", [*CATALOGUE, demo_spring.COMPONENT], ids=lambda c: c.interface.name)
def test_windows_library_shows_the_kernel_and_needs_the_system_only(component: Component) -> None:
    found = pe_file.read(_compiled(component, "win64"))
    assert (found.machine, found.magic) == (pe_file.AMD64, pe_file.PE32_PLUS)
    assert found.characteristics & pe_file.DLL
    step = "fmukit_advance" if component.interface.kind == "continuous" else "fmukit_sample"
    python = isinstance(component.kernel(), PythonKernel)
    assert set(found.exports) == ALWAYS | (set() if python else {"fmukit_initialise", step})
    other = [name for name in map(str.lower, found.imports) if not name.startswith("api-ms-win-crt-")]
    assert set(other) <= set(SYSTEM)
    assert found.imports


@pytest.mark.nightly
@needs_zig
def test_zigs_linux_library_runs_on_old_systems(zig_everywhere: None, tmp_path: Path) -> None:
    data = _compiled(CATALOGUE[0], "linux64")
    assert _needed(data, tmp_path) <= {"libc.so.6", "libm.so.6"}
    versions = {part.split(b"\0")[0].decode() for part in data.split(b"GLIBC_")[1:]}
    assert all(tuple(map(int, version.split("."))) <= (2, 28) for version in versions)
    assert _run_here(tmp_path / "kernel.so", CATALOGUE[0], 10).size


@pytest.mark.nightly
@needs_zig
@pytest.mark.skipif(sys.platform == "win32", reason="compares Linux libraries")
def test_quadratic_programs_by_clang_and_by_the_compiler_here_give_the_same_bits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here, there = tmp_path / "here.so", tmp_path / "zig.so"
    here.write_bytes(_compiled(demo_programs.COMPONENT, "linux64"))
    zig = (sys.executable, "-m", "ziglang", "cc", "-target", "x86_64-linux-gnu.2.28")
    monkeypatch.setattr(compiler, "command", lambda platform: zig)
    there.write_bytes(_compiled(demo_programs.COMPONENT, "linux64"))
    assert here.read_bytes() != there.read_bytes()
    found = [_run_here(path, demo_programs.COMPONENT, 50) for path in (here, there)]
    np.testing.assert_array_equal(*found)
    assert np.count_nonzero(found[0]) > 50


@pytest.mark.nightly
@needs_zig
def test_builds_for_both_platforms_are_identical(zig_everywhere: None, tmp_path: Path) -> None:
    for component in (demo_spring.COMPONENT, CATALOGUE[1]):
        one, other = (build(component, tmp_path / name, ["linux64", "win64"]) for name in ("one", "another/place"))
        assert one.read_bytes() == other.read_bytes()
        with zipfile.ZipFile(one) as archive:
            names = archive.namelist()
        assert {name.split("/")[1] for name in names if name.startswith("binaries/")} == {"linux64", "win64"}
        assert {name.rpartition("/")[2] for name in names if "/kernel." in name} == {"kernel.so", "kernel.dll"}


def _buffer(component: Component, size: int) -> np.ndarray:
    buffer = np.zeros(size)
    starts = [0.0 if v.type == "String" else float(v.start) for v in component.interface.variables]
    buffer[: len(starts)] = starts
    inputs = len(component.interface.select("parameter"))
    if component.interface.kind == "continuous":
        buffer[inputs] = 300.0  # the first motor's torque
    if component is demo_programs.COMPONENT:
        buffer[inputs : inputs + 2] = 2.5, 1.0  # a sum beyond some limits, a target away
    return buffer


def _run_here(path: Path, component: Component, steps: int) -> np.ndarray:
    """The buffer after `steps` steps of the Linux library, called as tests/fmukit/kernel_driver.c does."""
    kernel, step = ctypes.CDLL(str(path)), component.interface.step
    buffer = _buffer(component, kernel.fmukit_size())
    pointer, real, whole = ctypes.c_void_p(buffer.ctypes.data), ctypes.c_double, ctypes.c_int64
    assert kernel.fmukit_initialise(pointer, whole(7), None, real(0.0)) == 0
    for k in range(steps):
        if component.interface.kind == "continuous":
            assert kernel.fmukit_advance(pointer, real(step), whole(1)) == 0
        else:
            assert kernel.fmukit_sample(pointer, whole(7), whole(k + 1), real(k * step)) == 0
    return buffer


@pytest.fixture(scope="session")
def driver(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("windows") / "driver.exe"
    source = Path(__file__).with_name("kernel_driver.c")
    line = [*compiler.command("win64"), "-O2", "-s", "-o", str(made), str(source)]
    subprocess.run(line, check=True, capture_output=True)
    return made


@pytest.mark.nightly
@needs_zig
@needs_wine
@pytest.mark.parametrize("component", [*CATALOGUE[:4], demo_programs.COMPONENT], ids=lambda c: c.interface.name)
def test_windows_library_under_wine_gives_the_numbers_of_linux(
    component: Component, driver: Path, tmp_path: Path
) -> None:
    here, steps = tmp_path / "kernel.so", 200
    here.write_bytes(_compiled(component, "linux64"))
    (tmp_path / "kernel.dll").write_bytes(_compiled(component, "win64"))
    expected = _run_here(here, component, steps)
    _buffer(component, expected.size).tofile(tmp_path / "buffer.bin")
    line = [WINE, driver, "kernel.dll", "buffer.bin", "result.bin", str(steps), repr(component.interface.step)]
    quiet = {**os.environ, "WINEPREFIX": str(driver.parent / "prefix"), "WINEDEBUG": "-all"}
    subprocess.run(line, cwd=tmp_path, env=quiet, check=True, timeout=300, capture_output=True)
    found = np.fromfile(tmp_path / "result.bin")
    assert not np.array_equal(found, _buffer(component, expected.size))
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
