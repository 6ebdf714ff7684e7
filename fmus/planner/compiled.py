"""IPOPT for a program, its derivatives compiled to C once and kept in the user's cache."""

from __future__ import annotations

import os
import subprocess
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from time import perf_counter
from typing import Any

import casadi as ca

from fmukit.build import compiler
from fmukit.build.cache import cache_folder, check_writable, prune
from fmukit.build.errors import BuildError
from fmus.planner.program import Program

_FLAGS = ("-O1", "-fPIC", "-shared", "-w", "-s")
"""-O1: the derivatives are long straight code, which -O3 takes ten times as long to compile for nothing."""


@dataclass(frozen=True, slots=True)
class Solver:
    """`call` solves; `how` says what evaluates the derivatives; `build_time` [s] of making it."""

    call: ca.Function
    how: str
    build_time: float


def solver(program: Program, options: dict[str, Any], *, compile_: bool = True) -> Solver:
    """The solver, compiled if asked for and possible; without a compiler CasADi's virtual machine, saying so."""
    start = perf_counter()
    how = "interpreted"
    if compile_:
        try:
            return Solver(_load(program, options), "compiled", perf_counter() - start)
        except (BuildError, OSError) as error:
            how = f"interpreted, because {error}"
    call = ca.nlpsol("plan", "ipopt", program.nlp, options | program.derivatives)
    return Solver(call, how, perf_counter() - start)


def _load(program: Program, options: dict[str, Any]) -> ca.Function:
    """The solver on the library; a damaged library is made anew."""
    path = _library(program)
    try:
        return ca.nlpsol("plan", "ipopt", str(path), options)
    except RuntimeError:
        _make(program, path)
        return ca.nlpsol("plan", "ipopt", str(path), options)


def _library(program: Program) -> Path:
    """The compiled derivatives of the program, from the cache or made now."""
    path = cache_folder() / f"plan-{_key(program)}" / "nlp.so"
    if path.is_file():
        _used(path.parent)
        return path
    check_writable(path.parent)
    _make(program, path)
    prune(path.parent)
    return path


def _used(folder: Path) -> None:
    """Mark it as in use, so that it is not pruned; a folder that cannot be written is not pruned either."""
    with suppress(OSError):
        os.utime(folder)


def _key(program: Program) -> str:
    """Of the program itself, so that other numbers anywhere in it mean another library."""
    text = ca.Function("nlp", program.nlp, ["x", "p"], ["f", "g"]).serialize()
    text += "".join(function.serialize() for function in program.derivatives.values())
    parts = [text, ca.CasadiMeta.version(), compiler.identity(compiler.host_platform()), *_FLAGS]
    return blake2b("\n".join(parts).encode(), digest_size=10).hexdigest()


def _make(program: Program, path: Path) -> None:
    """Generate and compile beside the target, then move it there in one step: another process may do the same."""
    with tempfile.TemporaryDirectory(dir=path.parent) as name:
        folder = Path(name)
        generator = ca.nlpsol("plan", "ipopt", program.nlp, {"calc_lam_p": False, **program.derivatives})
        (folder / "nlp.c").write_text(_code(generator), "utf-8")
        line = [*compiler.command(compiler.host_platform()), *_FLAGS, "-o", "nlp.so", "nlp.c", "-lm"]
        done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode:
            said = (done.stderr.strip().splitlines() or ["no message"])[0]
            raise BuildError(f"the compiler {line[0]} failed ({said})")
        (folder / "nlp.so").replace(path)


def _code(generator: ca.Function) -> str:
    """C code of the program and of all its derivatives that IPOPT calls."""
    code = ca.CodeGenerator("nlp")
    code.add(generator.oracle())
    for name in generator.get_function():
        code.add(generator.get_function(name))
    return str(code.dump())
