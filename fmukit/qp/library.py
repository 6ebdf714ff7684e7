"""The compiled solver that CasADi calls while a model runs in this process, kept in the user's store."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from hashlib import blake2b
from pathlib import Path

from fmukit import store
from fmukit.compiling import compiler

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

    return store.kept(f"{symbol}-{_key(sources, platform)}", compiler.PLATFORMS[platform], make)


def _key(sources: Mapping[str, str], platform: str) -> str:
    digest = blake2b(compiler.identity(platform).encode() + _SHOWN.encode(), digest_size=8)
    for name in sorted(sources):
        digest.update(f"\n{name} {len(sources[name])}\n{sources[name]}".encode())
    return digest.hexdigest()


def _compile(symbol: str, sources: Mapping[str, str], units: tuple[str, ...], platform: str) -> bytes:
    texts = {**sources, "shown.c": _SHOWN.format(unit=f"{symbol}.c")}
    with tempfile.TemporaryDirectory(prefix="fmukit-") as folder:
        for name, text in texts.items():
            (Path(folder) / name).write_text(text, "utf-8")
        return compiler.run(Path(folder), platform, [unit for unit in units if unit != f"{symbol}.c"] + ["shown.c"])
