"""CasADi functions compiled into a library that `casadi.nlpsol` and `casadi.external` load."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import casadi as ca

from fmukit.compiling import compiler
from fmukit.compiling.kept import kept

FLAGS = ("-O1",)
"""The derivatives of an NLP are long straight code, on which -O2 may spend minutes and gigabytes for nothing."""


def code(functions: Sequence[ca.Function]) -> str:
    """C code of the functions, which depends on nothing but them and the version of CasADi."""
    generator = ca.CodeGenerator("functions.c", {"casadi_int": "long long int", "casadi_real": "double"})
    for function in functions:
        generator.add(function)
    return str(generator.dump())


def compiled(text: str, platform: str) -> bytes:
    """The library of the `code`; raises BuildError."""
    with tempfile.TemporaryDirectory(prefix="fmukit-") as name:
        folder = Path(name)
        (folder / "functions.c").write_text(f"#define GCC_HASCLASSVISIBILITY\n{text}", "utf-8")
        return compiler.run(folder, platform, ("functions.c",), FLAGS)


def file_name(name: str, platform: str) -> str:
    """`name` with the suffix of libraries of the platform."""
    return name + Path(compiler.PLATFORMS[platform]).suffix


def library(functions: Sequence[ca.Function], name: str, platform: str) -> Path:
    """The library `name` of the functions for `platform`, from the user's cache or compiled now; raises BuildError."""
    text = code(functions)
    return kept("library", [text, *FLAGS], file_name(name, platform), lambda: compiled(text, platform), [platform])
