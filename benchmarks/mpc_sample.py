"""A whole sample of MpcAllocator, compiled as in the FMU beside CasADi's own machine, solvers compiled in both.

Both are called from Python alike, with the same inputs at the same samples: those of the reference run.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import casadi as ca
import numpy as np

from benchmarks.spread import Spread, spread
from fmukit.compiling import compiler
from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmukit.packaging import codegen
from fmukit.reference_run import reference_run
from fmus.controllers.mpc_allocator import COMPONENT

ROUNDS = 3
# glibc has a function `step` of its own; ours must be seen
_FLAGS = ("-fvisibility=default", "-Wl,-Bsymbolic")


def measure(rounds: int = ROUNDS) -> tuple[Spread, Spread]:
    """Microseconds of a sample compiled and interpreted, their rounds in turns; raises RuntimeError if they differ."""
    kernel = COMPONENT.kernel()
    assert isinstance(kernel, Kernel)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        compiled = _compiled(kernel, Path(folder))
        pairs = [(_round(compiled), _round(kernel)) for _ in range(rounds)]
    for (_, ours), (_, theirs) in pairs:
        if not np.array_equal(ours, theirs):
            raise RuntimeError("the compiled sample and CasADi's machine disagree")
    return spread([ours for (ours, _), _ in pairs]), spread([theirs for _, (theirs, _) in pairs])


def rows(rounds: int | None) -> Iterator[tuple[str, str, str, str]]:
    """What `python -m benchmarks` prints."""
    ours, theirs = measure(rounds or ROUNDS)
    against = f"{ours.mean:.0f} us / {theirs.mean:.0f} us of a sample called from Python, reference run"
    yield "MpcAllocator: compiled against interpreted", f"{ours.mean / theirs.mean:.2f}", against, "< 1"


def _round(kernel: Kernel) -> tuple[np.ndarray, np.ndarray]:
    """Microseconds of every sample of the reference run, and the outputs (samples, outputs)."""
    played = reference_run(COMPONENT)
    assert played is not None
    instance = Direct(COMPONENT, inputs=played.inputs(0.0), kernel=kernel)
    times, outputs = [], []
    for k in range(round(played.stop / COMPONENT.interface.step)):
        instance.set(played.inputs(k * COMPONENT.interface.step))
        start = perf_counter()
        instance.sample()
        times.append(1e6 * (perf_counter() - start))
        outputs.append(instance.y)
    return np.array(times), np.array(outputs)


def _compiled(kernel: Kernel, folder: Path) -> Kernel:
    """The same kernel with its step from C code, compiled with the flags of an FMU."""
    code = codegen.generate(COMPONENT.interface, kernel)
    for name, text in {**code.solvers, "functions.c": code.functions}.items():
        (folder / name).write_text(text, "utf-8")
    platform = compiler.host_platform()
    compiler.run(folder, platform, ["functions.c", *code.units], _FLAGS)
    return replace(kernel, step=ca.external(kernel.step.name(), str(folder / compiler.PLATFORMS[platform])))


if __name__ == "__main__":
    for row in rows(None):
        print("  |  ".join(row))
