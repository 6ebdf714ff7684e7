"""What each output depends on at initialisation, from the sparsity of the kernel's own function."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import casadi as ca

from fmukit.interface import Interface
from fmukit.kernel import Kernel


def initial_dependencies(interface: Interface, kernel: Kernel) -> Mapping[str, Sequence[str]]:
    """Names of the parameters and inputs behind each output (structurally: an upper bound), in slot order."""
    p, u, w, table = (_pattern(_scalar_noise_and_table(kernel.initialise), i) for i in range(4))
    parameters, inputs = interface.names("parameter"), interface.names("input")
    result: dict[str, list[str]] = {"fault": []}
    for i, name in enumerate(interface.names("output")):
        found = {parameters[j] for j in p[i]} | {inputs[j] for j in u[i]}
        if w[i] and "seed" in parameters:
            found.add("seed")
        if interface.table and table[i]:
            found.add(interface.table.parameter)
        result[name] = [variable.name for variable in interface.variables if variable.name in found]
    return result


def _scalar_noise_and_table(initialise: ca.Function) -> ca.Function:
    """The function with one number standing for all noise and one for the whole table: far fewer columns."""
    p, u = (ca.MX.sym(name, initialise.size_in(i)) for i, name in enumerate("pu"))
    w, table = ca.MX.sym("w"), ca.MX.sym("table")
    filled = [ca.repmat(symbol, *initialise.size_in(i)) for i, symbol in ((2, w), (3, table))]
    return ca.Function("dependencies", [p, u, w, table], initialise.call([p, u, *filled, table]))


def _pattern(function: ca.Function, argument: int) -> list[list[int]]:
    """For each row of the outputs the columns of the argument it depends on."""
    count = function.numel_out(2)
    result: list[list[int]] = [[] for _ in range(count)]
    if not function.numel_in(argument):
        return result
    sparsity = function.jac_sparsity(2, argument)
    for row, column in zip(sparsity.row(), sparsity.get_col(), strict=True):
        result[row].append(column)
    return result
