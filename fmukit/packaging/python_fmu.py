"""What PythonFMU's own builder puts into an FMU: its binaries, its package, and the script that starts ours."""

from __future__ import annotations

import sys
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.metadata import distribution
from pathlib import Path, PurePosixPath

from pythonfmu import builder


def built(script: str, text: str, package: str, files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Members of the FMU PythonFMU builds from the script and the one package it imports."""
    # An FMU loaded into this process before has brought its own copy of PythonFMU, without libraries, perhaps gone.
    builder.HERE = Path(str(distribution("pythonfmu").locate_file("pythonfmu")))
    with tempfile.TemporaryDirectory(prefix="fmukit-") as name, _clean_imports(package, script):
        folder = Path(name)
        for member, data in files.items():
            path = folder / package / member
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        (folder / f"{script}.py").write_text(text, "utf-8")
        made = builder.FmuBuilder.build_FMU(folder / f"{script}.py", dest=folder, project_files=[folder / package])
        with zipfile.ZipFile(made) as archive:
            return {item.filename.replace("\\", "/"): archive.read(item) for item in archive.infolist()}


@contextmanager
def _clean_imports(package: str, script: str) -> Iterator[None]:
    """Leave neither the modules the builder imports nor its path entries behind, nor let it write bytecode."""
    path, bytecode = list(sys.path), sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    try:
        yield
    finally:
        sys.path[:], sys.dont_write_bytecode = path, bytecode
        for name in [name for name in sys.modules if name.partition(".")[0] in (package, script)]:
            del sys.modules[name]


def only_platforms(members: Mapping[str, bytes], platforms: tuple[str, ...]) -> dict[str, bytes]:
    """The members without the PythonFMU binaries of platforms the FMU has no kernel for, and without bytecode."""

    def wanted(name: str) -> bool:
        parts = PurePosixPath(name).parts
        return "__pycache__" not in parts and (parts[0] != "binaries" or parts[1] in platforms)

    return {name: data for name, data in members.items() if wanted(name)}
