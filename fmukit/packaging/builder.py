"""`build`: one component to one FMU file, the same bytes for the same sources and compiler."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from hashlib import blake2b
from pathlib import Path
from uuid import UUID

import pythonfmu

import fmukit.runtime
from fmukit import files
from fmukit.compiling import compiler
from fmukit.component import Component
from fmukit.errors import BuildError
from fmukit.interface import Interface
from fmukit.kernel import Kernel
from fmukit.packaging import about, crosscheck, python_fmu, xml
from fmukit.packaging.codegen import Code, generate
from fmukit.packaging.dependencies import initial_dependencies
from fmukit.packaging.description import described
from fmukit.packaging.documentation import documents
from fmukit.packaging.python_module import Embedded, embedded
from fmukit.packaging.recording import recorded
from fmukit.packing import pack
from fmukit.python_kernel import PythonKernel, packages

_INIT = '''"""Made by fmukit: the slave class of this FMU."""

from pathlib import Path

from .runtime import keep, slave_class

{name} = slave_class(Path(__file__).parent)
'''


def build(
    component: Component, directory: Path | str, platforms: Sequence[str] | None = None, *, bundle: bool = False
) -> Path:
    """Build `directory`/NAME.fmu for `platforms` (default: this one) and return its path; raises BuildError.

    With `bundle` the files of its cross-check are written beside it (none without a reference run).
    """
    interface = component.interface
    targets = tuple(platforms or (compiler.host_platform(),))
    for platform in targets:
        compiler.command(platform)
    kernel = component.kernel()
    _check_packages(component, kernel)
    recording = recorded(component, kernel)
    made = crosscheck.bundle(interface.name, recording, packages(kernel)) if bundle and recording else {}
    solvers = isinstance(kernel, Kernel) and bool(kernel.solvers)
    members = _model(interface, kernel, targets) | documents(component, recording, packages(kernel), solvers=solvers)
    made[f"{interface.name}.fmu"] = pack(members)
    for name, data in made.items():
        files.write(Path(directory) / name, data)
    return Path(directory) / f"{interface.name}.fmu"


def _check_packages(component: Component, kernel: Kernel | PythonKernel) -> None:
    named, needed = sorted(component.packages), sorted(packages(kernel))
    if named != needed:
        raise BuildError(
            f"the component {component.interface.name} names the packages {named}, but its kernel needs {needed}; "
            "name the same in both"
        )


def _model(interface: Interface, kernel: Kernel | PythonKernel, targets: tuple[str, ...]) -> dict[str, bytes]:
    """Members of the archive that make it run."""
    code = generate(interface, kernel)
    dependencies = None if isinstance(kernel, PythonKernel) else initial_dependencies(interface, kernel)
    modules = embedded(kernel, targets) if isinstance(kernel, PythonKernel) else None
    libraries = {platform: library(code, platform) for platform in targets}
    contents = _package(interface, code, modules, libraries)
    digest = _digest(contents)
    package = f"fmu_{digest.hex()[:16]}"
    script = f"{interface.name.lower()}_{digest.hex()[:16]}"
    text = f"from {package} import {interface.name}, keep\nkeep(globals())\n"
    members = python_fmu.only_platforms(python_fmu.built(script, text, package, contents), targets)
    guid = f"{{{UUID(bytes=digest[:16])}}}"
    members["modelDescription.xml"] = xml.describe(interface, guid, about.about(), dependencies)
    return members


def library(code: Code, platform: str) -> bytes:
    """The kernel and its solvers compiled for `platform`."""
    texts = {"functions.c": code.functions, "sizes.h": code.sizes, **code.solvers}
    with tempfile.TemporaryDirectory(prefix="fmukit-") as name:
        folder = Path(name)
        for file, text in texts.items():
            (folder / file).write_text(text, "utf-8")
        (folder / "shim.c").write_bytes((Path(__file__).parent / "shim.c").read_bytes())
        return compiler.run(folder, platform, ("shim.c", *code.units))


def _package(
    interface: Interface, code: Code, modules: Embedded | None, libraries: Mapping[str, bytes]
) -> dict[str, bytes]:
    """Files of the package inside the FMU."""
    runtime = Path(fmukit.runtime.__file__).parent
    return {
        **(modules.files if modules else {}),
        **{f"runtime/{path.name}": path.read_bytes() for path in sorted(runtime.glob("*.py"))},
        "__init__.py": _INIT.format(name=interface.name).encode(),
        "interface.json": described(interface, code, modules),
        **{compiler.PLATFORMS[platform]: data for platform, data in libraries.items()},
    }


def _digest(contents: Mapping[str, bytes]) -> bytes:
    """Hash of everything that makes up the behaviour of the FMU."""
    digest = blake2b(pythonfmu.__version__.encode(), digest_size=32)
    for name in sorted(contents):
        digest.update(f"{name} {len(contents[name])}\n".encode() + contents[name])
    return digest.digest()
