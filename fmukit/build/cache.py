"""FMUs and libraries made before. Nothing here imports casadi unless something has to be built."""

from __future__ import annotations

import tempfile
import zipfile
from collections.abc import Sequence
from hashlib import blake2b
from importlib.metadata import version
from pathlib import Path
from shutil import rmtree
from time import time

from platformdirs import user_cache_path

from fmukit.build import compiler
from fmukit.build.errors import BuildError
from fmukit.build.sources import fingerprint
from fmukit.component import Component

_KEEP = 30 * 24 * 3600.0


def cache_folder() -> Path:
    """Where built FMUs are kept; may be deleted at any time."""
    return user_cache_path("vehicle-formation-fmus")


def cached(component: Component, directory: Path | None = None, platforms: Sequence[str] | None = None) -> Path:
    """The component's FMU, built when its sources, tools or compiler have changed since it was built last.

    A damaged file is built anew. Raises BuildError, also when the folder cannot be written.
    """
    targets = tuple(platforms or (compiler.host_platform(),))
    name = component.interface.name
    path = (directory or cache_folder()) / f"{name}-{_key(component, targets)}" / f"{name}.fmu"
    if not _sound(path):
        check_writable(path.parent)
        from fmukit.build.builder import build  # noqa: PLC0415 (imports casadi)

        build(component, path.parent, targets)
        prune(path.parent)
    return path


def _sound(path: Path) -> bool:
    """Whether the file is there and whole: an interrupted copy or a full disk may have left half of it."""
    try:
        with zipfile.ZipFile(path) as archive:
            return "modelDescription.xml" in archive.namelist() and archive.testzip() is None
    except Exception:  # damaged bytes make zipfile raise almost anything
        return False


def check_writable(folder: Path) -> None:
    """Say so before the long build."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"x")
    except OSError as error:
        raise BuildError(
            f"the cache folder {folder} cannot be written ({error.strerror}); "
            "make it writable, free some space, or name another place in XDG_CACHE_HOME"
        ) from error


def prune(made: Path) -> None:
    """Remove what was built of the same name more than a month ago."""
    pattern = made.name.rpartition("-")[0] + "-*"
    for other in made.parent.glob(pattern):
        if time() - other.stat().st_mtime > _KEEP:
            rmtree(other, ignore_errors=True)


def _key(component: Component, platforms: tuple[str, ...]) -> str:
    tools = [f"{tool} {version(tool)}" for tool in ("casadi", "osqp", "pythonfmu")]
    compilers = [f"{platform} {compiler.identity(platform)}" for platform in platforms]
    parts = [component.model, repr(component.interface), fingerprint(component), *tools, *compilers]
    return blake2b("\n".join(parts).encode(), digest_size=8).hexdigest()
