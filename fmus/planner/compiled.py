"""IPOPT for a program, its derivatives compiled to C once and kept in the user's cache."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import casadi as ca

from fmukit.compiling import compiler, functions
from fmukit.compiling.kept import kept
from fmukit.errors import BuildError
from fmukit.python_kernel import nlp_functions
from fmus.planner.program import NonlinearProgram


@dataclass(frozen=True, slots=True)
class Solver:
    """`call` solves; `how` says what evaluates the derivatives; `build_time` [s] of making it."""

    call: ca.Function
    how: str
    build_time: float


def solver(program: NonlinearProgram, options: dict[str, Any], *, compile_: bool = True) -> Solver:
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


def _load(program: NonlinearProgram, options: dict[str, Any]) -> ca.Function:
    platform = compiler.host_platform()

    def make() -> bytes:
        code = functions.code(nlp_functions(program.nlp, program.derivatives))
        return functions.compiled(code, platform)

    path = kept("plan", _sources(program), functions.file_name("nlp", platform), make, [platform])
    try:
        return ca.nlpsol("plan", "ipopt", str(path), options)
    except RuntimeError as error:
        raise BuildError(f"{path} cannot be loaded; may programs be run from that folder?") from error


def _sources(program: NonlinearProgram) -> list[str]:
    """The program itself, so that other numbers anywhere in it mean another library."""
    text = ca.Function("nlp", program.nlp, ["x", "p"], ["f", "g"]).serialize()
    derivatives = [function.serialize() for function in program.derivatives.values()]
    return [text, *derivatives, ca.CasadiMeta.version(), *functions.FLAGS]
