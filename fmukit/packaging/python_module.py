"""The Python modules and the libraries of a component that is a `PythonKernel`, as files of its FMU."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from pathlib import Path

from fmukit.compiling import functions
from fmukit.errors import BuildError
from fmukit.python_kernel import PythonKernel

FOLDER = "model"


def modules(kernel: PythonKernel) -> dict[str, Path]:
    """The files of the kernel's module and of all it imports, by dotted name, the module itself first.

    Raises BuildError when one of them imports what will not be there.
    """
    found: dict[str, Path] = {}
    waiting = [kernel.module]
    while waiting:
        name = waiting.pop(0)
        if name not in found:
            found[name] = _file(name)
            waiting += _imports(name, found[name], kernel)
    return found


@dataclass(frozen=True, slots=True)
class Embedded:
    """`files` of the FMU's package by path, and what the runtime is told of them.

    `modules` by their names in that package, the first being the one called; `libraries` by name; `packages` are what
    the host must have, with the least version of each.
    """

    files: dict[str, bytes]
    modules: list[str]
    libraries: list[str]
    packages: dict[str, str]


def embedded(kernel: PythonKernel, platforms: Sequence[str]) -> Embedded:
    """The modules and the libraries as they lie in an FMU for the platforms; raises BuildError."""
    made, names = {f"{FOLDER}/__init__.py": b""}, []
    for name, path in modules(kernel).items():
        inside = [FOLDER, *(name.split(".")[1:] or [name])]
        made |= {"/".join([*inside[:depth], "__init__.py"]): b"" for depth in range(1, len(inside))}
        made["/".join(inside) + ".py"] = path.read_bytes()
        names.append(".".join(inside))
    for platform in platforms:
        libraries = [functions.library(library, name, platform) for name, library in kernel.libraries.items()]
        made |= {path.name: path.read_bytes() for path in libraries}
    return Embedded(made, names, list(kernel.libraries), dict(kernel.packages))


def _file(name: str) -> Path:
    spec = _spec(name)
    if spec is not None and spec.submodule_search_locations is not None:
        raise BuildError(f"{name} is a package, whose __init__ does not travel in an FMU; import modules of it by name")
    if spec is None or spec.origin is None or not spec.origin.endswith(".py"):
        raise BuildError(f"the module {name} does not exist or is not a Python file; it cannot travel in an FMU")
    return Path(spec.origin)


def _spec(name: str) -> ModuleSpec | None:
    try:
        return find_spec(name)
    except ModuleNotFoundError:
        return None


def _imports(name: str, path: Path, kernel: PythonKernel) -> Iterator[str]:
    """The names of the modules that `name` imports relatively; any other import must be found in the host."""
    there = sys.stdlib_module_names | kernel.packages.keys()
    for node in ast.walk(ast.parse(path.read_text("utf-8"), str(path))):
        if isinstance(node, ast.ImportFrom) and node.level:
            yield from _relative(name, node)
        elif isinstance(node, ast.Import | ast.ImportFrom):
            wanted = [node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]
            absent = [module for module in wanted if module.partition(".")[0] not in there]
            if absent:
                raise BuildError(
                    f"{path.name}, line {node.lineno}: imports {absent[0]}, which an FMU will not find; what shall "
                    f"travel with it is imported relatively, and else only the standard library and "
                    f"{', '.join(kernel.packages)}"
                )


def _relative(name: str, node: ast.ImportFrom) -> Iterator[str]:
    parent = ".".join(name.split(".")[: -node.level])
    if not parent:
        raise BuildError(f"{name}, line {node.lineno}: the relative import leaves the package")
    source = f"{parent}.{node.module}" if node.module else parent
    spec = _spec(source)
    if spec is not None and spec.submodule_search_locations is not None:
        yield from (f"{source}.{alias.name}" for alias in node.names)
    else:
        yield source
