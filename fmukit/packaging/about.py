"""Author, version, licence and date written into every FMU."""

from __future__ import annotations

import os
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from fmukit import __version__
from fmukit.packaging.xml import About

_PROJECT = "vehicle-formation-fmus"
_EPOCH = 1767225600
_OSQP = """The kernel libraries of this FMU contain C code of OSQP {version} and of its part QDLDL, unchanged, and a
workspace that OSQP's code generation made.

OSQP
Copyright (c) 2019 Bartolomeo Stellato, Goran Banjac, Paul Goulart, Stephen Boyd
This product includes software developed at Stanford University and at the University of Oxford.

QDLDL
Copyright (c) 2018, Paul Goulart, Bartolomeo Stellato, Goran Banjac, Ian McInerney, The OSQP developers

Both are under the following licence.

{text}"""


def about() -> About:
    """The date is that of `SOURCE_DATE_EPOCH`, else a fixed one: two builds of the same sources are identical."""
    seconds = int(os.environ.get("SOURCE_DATE_EPOCH", _EPOCH))
    date = datetime.fromtimestamp(seconds, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    authors = f"The authors of {_PROJECT}"
    return About(authors, __version__, "MIT", f"Copyright (c) 2026 {authors}", date)


def licences(solvers: bool = False) -> dict[str, bytes]:
    """Licence texts of this project and of PythonFMU, of OSQP with `solvers`, as members of the FMU."""
    texts = {_PROJECT: _project_licence(), "pythonfmu": distribution("pythonfmu").read_text("licenses/LICENSE")}
    if solvers:
        osqp = distribution("osqp")
        texts["osqp"] = _OSQP.format(version=osqp.version, text=osqp.read_text("licenses/LICENSE"))
    folder = "documentation/licenses"
    return {f"{folder}/{name}.txt": text.encode() for name, text in texts.items() if text}


def _project_licence() -> str | None:
    beside = Path(__file__).parents[2] / "LICENSE"
    if beside.is_file():
        return beside.read_text("utf-8")
    try:
        return distribution(_PROJECT).read_text("licenses/LICENSE")
    except PackageNotFoundError:
        return None
