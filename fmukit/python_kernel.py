"""What an FMU computes that no pure function can: a Python module inside the FMU, with compiled libraries beside it.

For a component that must search at run time (an NLP solved by IPOPT). All others are a `fmukit.kernel.Kernel`, which
needs no packages in the host and is faster by orders of magnitude.

The component's model module (imported at build time only) returns the `PythonKernel` from its function `kernel()`. The
module named there travels, with every module it imports relatively, whatever depth, and nothing else: no `__init__.py`,
no data files. These modules may import the standard library, the kernel's packages and each other (relatively, which
the build checks). The named module defines three functions:

    prepare(libraries) -> tools
        once per process: `libraries` maps the kernel's library names to the paths of their files, as
        `casadi.nlpsol(name, "ipopt", path, options)` takes them. `tools` is shared by all instances: no state in it.
    initialise(tools, p, u, table) -> (d, x, y)
    sample(tools, p, d, u, x, t) -> (x, y)

with the letters of `fmukit.kernel`: `p` and `u` are dicts by name (in `p` Boolean values are bool, Integer int, String
str), `y` is a dict of all outputs but `fault`, `d` and `x` are sequences of floats of fixed length (given: `array("d")`
of their own, to read or change at will; taken: list, array or numpy array), `t` is the time since the start of the
sampling grid [s], `table` the rows of the CSV file (a list of lists, empty without a file).

Both must be pure: the same arguments give the same bits, and nothing is remembered outside `x`. What the user can put
right they say by raising ValueError with one sentence. Any exception, a wrong length, a missing name and a value that
is not finite end as a discarded step with the last good state, outputs and states kept. Nothing may be printed: give
solvers `{"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}`. The runtime calls the modules of a process
one at a time, since solvers give up Python's global lock while they work.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from fmukit.kernel import Kernel

_OPTIONS = {"calc_lam_p": False}


@dataclass(frozen=True, slots=True)
class PythonKernel:
    """`module` by its dotted name; `derived` and `states` are the lengths of d and x.

    `libraries` are compiled for each platform of the FMU: name -> functions with the names they are called by.
    `packages` are what the host must have, with the least version of each.
    """

    module: str
    states: int
    derived: int = 0
    libraries: Mapping[str, tuple[ca.Function, ...]] = field(default_factory=dict)
    packages: Mapping[str, str] = field(default_factory=lambda: {"casadi": "3.7"})


def nlp_functions(
    nlp: dict[str, ca.SX] | dict[str, ca.MX], derivatives: Mapping[str, ca.Function] | None = None
) -> tuple[ca.Function, ...]:
    """The functions of a library for `casadi.nlpsol(name, "ipopt", path, options)`: the NLP and its derivatives.

    The options given there must have `calc_lam_p` False, as here. A library holds one NLP. `derivatives`: options
    `jac_g` and `hess_lag` with functions better than those CasADi would make.
    """
    options: dict[str, Any] = {**_OPTIONS, **(derivatives or {})}
    solver = ca.nlpsol("nlp_solver", "ipopt", nlp, options)
    return (solver.oracle(), *(solver.get_function(name) for name in solver.get_function()))


def packages(kernel: Kernel | PythonKernel) -> Mapping[str, str]:
    """What the host of an FMU made of this kernel must have: package -> least version."""
    return kernel.packages if isinstance(kernel, PythonKernel) else {}
