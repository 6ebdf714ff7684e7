"""From a kernel to C: CasADi's code of its functions, and a header with the sizes the shim needs."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

import casadi as ca

from fmukit.interface import Interface
from fmukit.kernel import Kernel
from fmukit.python_kernel import PythonKernel

_WORK = re.compile(r"\*sz_(arg|res|iw|w) = (\d+);")


@dataclass(frozen=True, slots=True)
class Code:
    """`functions` and `sizes` are the texts of functions.c and sizes.h; `derived`, `states` the hidden slots.

    `solvers` are the texts of the solvers' files by name, `units` those of them to compile.
    """

    functions: str
    sizes: str
    derived: int
    states: int
    solvers: Mapping[str, str] = field(default_factory=dict)
    units: tuple[str, ...] = ()


def generate(interface: Interface, kernel: Kernel | PythonKernel) -> Code:
    """The C code of a component, the same text for the same kernel."""
    if isinstance(kernel, PythonKernel):
        return _without_functions(interface, kernel)
    functions = {"INITIALISE": _dense(kernel.initialise), "STEP": _dense(kernel.step)}
    if kernel.output is not None:
        functions["OUTPUT"] = _dense(kernel.output)
    generator = ca.CodeGenerator("functions.c", {"casadi_int": "long long int", "casadi_real": "double"})
    for function in functions.values():
        generator.add(function)
    text = generator.dump()
    derived, states = kernel.initialise.numel_out(0), kernel.initialise.numel_out(1)
    texts = {name: text for solver in kernel.solvers for name, text in solver.sources.items()}
    units = tuple(dict.fromkeys(unit for solver in kernel.solvers for unit in solver.units))
    return Code(text, _header(interface, functions, text, derived, states), derived, states, texts, units)


def _without_functions(interface: Interface, kernel: PythonKernel) -> Code:
    """The library of a component that is a Python module: it knows the size of the buffer and checks limits."""
    if interface.kind != "sampled" or interface.noise:
        raise ValueError(f"{interface.name} is a Python module, which must be sampled and without noise")
    header = _header(interface, {}, "", kernel.derived, kernel.states)
    types = "#define casadi_int long long int\n"
    return Code(types, f"{header}#define PYTHON 1\n", kernel.derived, kernel.states, {}, ())


def _dense(function: ca.Function) -> ca.Function:
    """The function itself, or around one with structural zeros in its results one that writes them out."""
    if all(function.sparsity_out(i).is_dense() for i in range(function.n_out())):
        return function
    arguments = [ca.MX.sym(f"i{i}", *function.size_in(i)) for i in range(function.n_in())]
    results = function.call(arguments, False, True)
    return ca.Function(f"{function.name()}_dense", arguments, [ca.densify(result) for result in results])


def _header(interface: Interface, functions: dict[str, ca.Function], text: str, derived: int, states: int) -> str:
    sizes = {
        "CONTINUOUS": int(interface.kind == "continuous"),
        "PARAMETERS": len(interface.names("parameter")),
        "INPUTS": len(interface.names("input")),
        "OUTPUTS": len(interface.names("output")),
        "DERIVED": derived,
        "STATES": states,
        "NOISE": interface.noise,
    }
    for work in ("arg", "res", "iw", "w"):
        needed = [int(number) for name, number in _WORK.findall(text) if name == work]
        sizes[f"SZ_{work.upper()}"] = max([1, *needed])
    names = {role: function.name() for role, function in functions.items()}
    return "".join(f"#define {key} {value}\n" for key, value in {**sizes, **names}.items())
