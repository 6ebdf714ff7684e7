"""FMUs out of the user's cache. Nothing here imports casadi unless an FMU has to be built."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path

from fmukit.compiling import compiler
from fmukit.compiling.kept import kept
from fmukit.component import Component
from fmukit.packaging.sources import fingerprint


def cached(component: Component, directory: Path | None = None, platforms: Sequence[str] | None = None) -> Path:
    """The component's FMU, built when its sources, tools or compiler have changed since it was built last.

    A damaged file is built anew. Without a compiler it is what any compiler has made of the same sources. Raises
    BuildError, also when the folder cannot be written.
    """
    targets = tuple(platforms or (compiler.host_platform(),))
    name = component.interface.name

    def make() -> bytes:
        from fmukit.packaging.builder import build  # noqa: PLC0415 (imports casadi: a warm cache needs no build tools)

        with tempfile.TemporaryDirectory(prefix="fmukit-") as folder:
            return build(component, folder, targets).read_bytes()

    return kept(name, _sources(component, targets), f"{name}.fmu", make, targets, directory)


def _sources(component: Component, platforms: tuple[str, ...]) -> list[str]:
    tools = [f"{tool} {version(tool)}" for tool in ("casadi", "osqp", "pythonfmu")]
    return [component.model, repr(component.interface), fingerprint(component), *tools, *platforms]
