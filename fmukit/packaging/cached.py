"""FMUs out of the user's cache. Nothing here imports casadi unless an FMU has to be built."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from hashlib import blake2b
from importlib.metadata import version
from pathlib import Path

from fmukit.compiling import compiler
from fmukit.component import Component
from fmukit.packaging.sources import fingerprint
from fmukit.store import kept


def cached(component: Component, directory: Path | None = None, platforms: Sequence[str] | None = None) -> Path:
    """The component's FMU, built when its sources, tools or compiler have changed since it was built last.

    A damaged file is built anew. Raises BuildError, also when the folder cannot be written.
    """
    targets = tuple(platforms or (compiler.host_platform(),))
    name = component.interface.name

    def make() -> bytes:
        from fmukit.packaging.builder import build  # noqa: PLC0415 (imports casadi: a warm cache needs no build tools)

        with tempfile.TemporaryDirectory(prefix="fmukit-") as folder:
            return build(component, folder, targets).read_bytes()

    return kept(f"{name}-{_key(component, targets)}", f"{name}.fmu", make, directory)


def _key(component: Component, platforms: tuple[str, ...]) -> str:
    tools = [f"{tool} {version(tool)}" for tool in ("casadi", "osqp", "pythonfmu")]
    compilers = [f"{platform} {compiler.identity(platform)}" for platform in platforms]
    parts = [component.model, repr(component.interface), fingerprint(component), *tools, *compilers]
    return blake2b("\n".join(parts).encode(), digest_size=8).hexdigest()
