"""The compiled solver that CasADi calls while a model runs in this process, kept in the user's store."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path

from fmukit.compiling import compiler
from fmukit.compiling.kept import kept

_SHOWN = """#if defined(_WIN32)
#define API __declspec(dllexport)
#else
#define API __attribute__((visibility("default")))
#endif
#include "{unit}"
"""


def compiled(symbol: str, sources: Mapping[str, str], units: tuple[str, ...]) -> Path:
    """Path of the library that shows the functions of `symbol`; compiled when it is not there yet, or damaged."""
    platform = compiler.host_platform()

    def make() -> bytes:
        return _compile(symbol, sources, units, platform)

    parts = [_SHOWN, *(f"{name}\n{sources[name]}" for name in sorted(sources))]
    return kept(symbol, parts, compiler.PLATFORMS[platform], make, [platform])


def _compile(symbol: str, sources: Mapping[str, str], units: tuple[str, ...], platform: str) -> bytes:
    texts = {**sources, "shown.c": _SHOWN.format(unit=f"{symbol}.c")}
    with tempfile.TemporaryDirectory(prefix="fmukit-") as folder:
        for name, text in texts.items():
            (Path(folder) / name).write_text(text, "utf-8")
        return compiler.run(Path(folder), platform, [unit for unit in units if unit != f"{symbol}.c"] + ["shown.c"])
