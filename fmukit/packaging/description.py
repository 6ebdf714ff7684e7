"""interface.json: what the runtime inside an FMU is told of the component, and reads in its own `description`."""

from __future__ import annotations

import json
from dataclasses import asdict

from fmukit.interface import Interface, Variable
from fmukit.packaging.codegen import Code
from fmukit.packaging.python_module import Embedded


def described(interface: Interface, code: Code, modules: Embedded | None) -> bytes:
    """The file; `modules` are those that stand in place of a compiled kernel, if any."""
    table = interface.table
    content = {
        "name": interface.name,
        "kind": interface.kind,
        "step": interface.step,
        "max_substep": interface.max_substep if interface.kind == "continuous" else None,
        "most": _most(code, modules),
        "derived": code.derived,
        "states": code.states,
        "table": table and asdict(table),
        "program": modules and _program(modules),
        "advice": [asdict(advice) for advice in interface.advice],
        "variables": [_entry(variable) for variable in interface.variables],
    }
    return json.dumps(content, indent=1).encode()


def _most(code: Code, modules: Embedded | None) -> int:
    """How many substeps or samples a step of a host may take: some seconds of work of whatever computes them."""
    if modules:
        return 1_000
    return 10_000 if code.solvers else 100_000


def _program(modules: Embedded) -> dict[str, object]:
    return {"modules": modules.modules, "libraries": modules.libraries, "packages": modules.packages}


def _entry(variable: Variable) -> dict[str, object]:
    """What the runtime needs of a variable; its value reference is its place in the list."""
    return {
        "name": variable.name,
        "type": variable.type,
        "causality": variable.causality,
        "start": variable.start if variable.type == "String" else float(variable.start),
        "minimum": variable.minimum,
        "maximum": variable.maximum,
        "unit": variable.unit,
    }
