"""What is needed to build the FMU: the NLP, and the module that solves it at run time."""

from __future__ import annotations

import casadi as ca

from fmukit.python_kernel import PythonKernel, nlp_functions


def kernel() -> PythonKernel:
    x, p = ca.SX.sym("x", 2), ca.SX.sym("p", 3)
    nlp = {"x": x, "p": p, "f": ca.sumsqr(x - p[:2]), "g": x[0] * x[1] - p[2]}
    return PythonKernel("demo_search.run", states=3, derived=11, libraries={"hyperbola": nlp_functions(nlp)})
