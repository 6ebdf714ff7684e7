"""From the patterns of a quadratic program to C: OSQP's own code generation, and our function around it."""

from __future__ import annotations

import re
import tempfile
from functools import cache
from importlib.resources import files
from pathlib import Path

import casadi as ca
import numpy as np
import osqp
from scipy import sparse

from fmukit.qp.settings import QpSettings

COMMON = "node.c"
_COMMENT = re.compile(r"/\*.*?\*/\n*", re.DOTALL)
_NUMBERS = re.compile(r"^(OSQPFloat\s+\w+(?<!_KKT_x)\[\d+\]) = \{[^}]*\};", re.MULTILINE)
_DEFINITION = re.compile(r"^(?=(?:OSQP|QDLDL_|qdldl_)\w*\s+\w+(?:\[\d+\])?(?: =|;))", re.MULTILINE)


def sources(symbol: str, P: ca.Sparsity, A: ca.Sparsity, settings: QpSettings) -> dict[str, str]:
    """Texts of the C files by name, all for one folder; compile `units` of them. The same for the same arguments."""
    workspace, configuration = _generated(symbol, P, A, settings)
    values = {
        "NAME": symbol,
        "RHO": repr(settings.rho),
        "NNZ_P": P.nnz(),
        "NNZ_A": A.nnz(),
        "N": A.size2(),
        "M": A.size1(),
    }
    text = _own("solver.c")
    for key, value in values.items():
        text = text.replace(f"@{key}@", str(value))
    own = {f"{symbol}.c": text, f"{symbol}_osqp_workspace.c": workspace, "osqp_configure.h": configuration}
    return own | {COMMON: _own(COMMON)} | _osqp()


def _own(name: str) -> str:
    return (Path(__file__).parent / name).read_text("utf-8")


@cache
def _osqp() -> dict[str, str]:
    """OSQP's own files, as installed."""
    root = files("osqp.codegen").joinpath("codegen_src")
    folders = [root.joinpath(*parts) for parts in (("src",), ("inc", "public"), ("inc", "private"))]
    return {file.name: file.read_text("utf-8") for folder in folders for file in folder.iterdir()}


def _generated(symbol: str, P: ca.Sparsity, A: ca.Sparsity, settings: QpSettings) -> tuple[str, str]:
    """Workspace and configuration. The numbers it was set up with are dropped: every call writes its own."""
    solver = osqp.OSQP(algebra="builtin")
    n, m = P.size1(), A.size1()
    solver.setup(_identity(P), np.zeros(n), _ones(A), -np.ones(m), np.ones(m), **settings.osqp())
    with tempfile.TemporaryDirectory(prefix="fmukit-") as folder:
        solver.codegen(
            folder,
            parameters="matrices",
            extension_name=None,
            include_codegen_src=False,
            force_rewrite=True,
            prefix=f"{symbol}_osqp_",
        )
        workspace = (Path(folder) / f"{symbol}_osqp_workspace.c").read_text("utf-8")
        configuration = (Path(folder) / "osqp_configure.h").read_text("utf-8")
    workspace = _NUMBERS.sub(r"\1;", _COMMENT.sub("", workspace))
    return _DEFINITION.sub("static ", workspace), _COMMENT.sub("", configuration)


def _identity(pattern: ca.Sparsity) -> sparse.csc_matrix:
    """Ones on the diagonal, explicit zeros elsewhere: convex for any pattern."""
    values = [float(i == j) for i, j in zip(*pattern.get_triplet(), strict=True)]
    return _matrix(pattern, values)


def _ones(pattern: ca.Sparsity) -> sparse.csc_matrix:
    return _matrix(pattern, [1.0] * pattern.nnz())


def _matrix(pattern: ca.Sparsity, values: list[float]) -> sparse.csc_matrix:
    return sparse.csc_matrix((np.array(values), pattern.row(), pattern.colind()), shape=pattern.shape)
