"""RecedingHorizonPlanner: what is compiled, and the module that runs around it."""

from __future__ import annotations

from fmukit.python_kernel import PythonKernel, nlp_functions
from fmus.planner.receding.layout import HORIZON, LONG
from fmus.planner.receding.local import motion, problem
from fmus.planner.receding.memory import size
from fmus.planner.receding.road import DERIVED


def kernel(horizons: tuple[int, ...] = (HORIZON, LONG)) -> PythonKernel:
    """The kernel, with local problems of as many intervals."""
    problems = {f"local{horizon}": problem(horizon) for horizon in horizons}
    libraries = {name: nlp_functions(local.nlp, local.derivatives) for name, local in problems.items()}
    return PythonKernel(
        "fmus.planner.receding.run",
        states=size(LONG),
        derived=DERIVED,
        libraries={**libraries, "motion": (motion(),)},
        packages={"casadi": "3.7", "numpy": "2.0"},
    )
