"""RecedingHorizonPlanner: what is compiled, and the module that runs around it."""

from __future__ import annotations

from fmukit.python_kernel import PythonKernel, nlp_functions
from fmus.planner.receding.layout import HORIZON
from fmus.planner.receding.local import motion, problem
from fmus.planner.receding.memory import size
from fmus.planner.receding.road import DERIVED


def kernel(horizon: int = HORIZON) -> PythonKernel:
    """The kernel, with local problems of `horizon` intervals."""
    local = problem(horizon)
    return PythonKernel(
        "fmus.planner.receding.run",
        states=size(horizon),
        derived=DERIVED,
        libraries={"local": nlp_functions(local.nlp, local.derivatives), "motion": (motion(),)},
        packages={"casadi": "3.7", "numpy": "2.0"},
    )
