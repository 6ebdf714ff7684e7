"""A `Kernel` from the equations of a component."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

import casadi as ca

from fmukit.integration import stages
from fmukit.interface import Interface
from fmukit.kernel.assembly import Assembly, Equations
from fmukit.kernel.columns import Layout, Parts
from fmukit.kernel.functions import Expression
from fmukit.kernel.kernel import Kernel

if TYPE_CHECKING:
    from fmukit.qp.solver import QpSolver

_NONE = Layout()


def sampled_kernel(
    interface: Interface,
    *,
    initialise: Equations,
    sample: Equations,
    states: Layout = _NONE,
    derived: Layout = _NONE,
    symbol: Expression = ca.SX,
    solvers: Iterable[QpSolver] = (),
) -> Kernel:
    """The kernel of a component that computes on its own grid.

    initialise  of p, u, w, table, rows -> derived values, states, outputs by name; what is left out is zero
    sample      of p, u, d, x, w, t -> states and outputs by name, all of them

    `symbol` is what both are written in, `casadi.SX` or `casadi.MX`. `solvers` are the quadratic programs they call.
    Raises ValueError for equations that take or give what the component does not have, and for a solver that is called
    but not given.
    """
    of = Assembly(interface, states, derived)
    begun = {"d": derived.begun, "x": states.begun, "y": of.outputs.begun}
    start = of.function("initialise", initialise, of.at_start, begun, symbol=symbol)
    arguments = of.now | {"w": interface.noise, "t": 1}
    step = of.function("step", sample, arguments, {"x_next": states.join, "y": of.outputs.join}, symbol=symbol)
    given = tuple(solvers)
    _check_solvers(interface.name, (start, step), given)
    return Kernel(start, step, solvers=given)


def continuous_kernel(
    interface: Interface,
    *,
    initialise: Equations,
    derivative: Equations,
    output: Equations,
    states: Layout,
    derived: Layout = _NONE,
    project: Callable[[Parts], Parts] | None = None,
    symbol: Expression = ca.SX,
) -> Kernel:
    """The kernel of a component that is integrated by the Runge-Kutta method of order four.

    initialise  of p, u -> derived values and states by name; what is left out is zero
    derivative  of p, u, d, x -> the states' time derivatives by name
    output      of p, u, d, x -> outputs by name
    project     of x -> states by name, put right after every step (the length of a quaternion)

    `symbol` is what `initialise` is written in. The others are in SX; `derivative` stays one function in the C code.
    Raises ValueError for equations that take or give what the component does not have.
    """
    of = Assembly(interface, states, derived)
    rate = of.function("derivative", derivative, of.now, {"x_dot": states.join}, cse=True)
    p, d, u, x = (ca.MX.sym(name, rate.numel_in(name)) for name in of.now)
    h = ca.MX.sym("h")
    k_1, k_2, k_3, k_4 = stages(lambda state, _: rate(p, d, u, state), x, h)
    after = x + h / 6 * (k_1 + 2 * (k_2 + k_3) + k_4)
    if project is not None:
        after = of.function("project", project, {"x": states}, {"x_next": states.join})(after)
    step = ca.Function("step", [p, d, u, x, h], [after], ["p", "d", "u", "x", "h"], ["x_next"])
    return replace(of.continuous(initialise, step, output, symbol), derivative=rate)


def exact_kernel(
    interface: Interface,
    *,
    initialise: Equations,
    step: Equations,
    output: Equations,
    states: Layout,
    derived: Layout = _NONE,
) -> Kernel:
    """The kernel of a continuous component whose motion under held inputs is known in closed form.

    step  of p, u, d, x, h -> states by name after h [s]

    The rest is as for `continuous_kernel`.
    """
    of = Assembly(interface, states, derived)
    later = of.function("step", step, of.now | {"h": 1}, {"x_next": states.join})
    return of.continuous(initialise, later, output, ca.SX)


def _check_solvers(owner: str, functions: Iterable[ca.Function], solvers: tuple[QpSolver, ...]) -> None:
    given = [solver.function.name() for solver in solvers]
    called = {inner.name() for f in functions for inner in f.find_functions() if inner.class_name() == "External"}
    twice = sorted({name for name in given if given.count(name) > 1})
    if twice or called - set(given):
        raise ValueError(f"{owner}: solvers given twice {twice}, called but not given {sorted(called - set(given))}")
