"""What a user finds inside an FMU beside the model: page, pictures, licences, requirements."""

from __future__ import annotations

from collections.abc import Mapping

from fmukit import __version__
from fmukit.component import Component
from fmukit.packaging import about, pictures
from fmukit.packaging.page import NONE, page
from fmukit.packaging.recording import Recording
from fmukit.packaging.sources import component_folder


def documents(
    component: Component, recording: Recording | None, packages: Mapping[str, str] = NONE, *, solvers: bool = False
) -> dict[str, bytes]:
    """Members of the archive by name; without a `recording` of its reference run the page has no plot.

    `packages` are what the host's Python needs, with the least versions; `solvers`: OSQP's code is inside.
    """
    interface, run = component.interface, recording.run if recording else None
    members = {
        "resources/requirements.txt": "".join(f"{name}>={least}\n" for name, least in packages.items()).encode(),
        "model.png": pictures.block(interface),
        "documentation/index.html": page(interface, _readme(component), run, __version__, packages).encode(),
        **about.licences(solvers),
    }
    if recording is not None:
        members["documentation/reference_run.png"] = pictures.plot(interface, recording)
    return members


def _readme(component: Component) -> str:
    path = component_folder(component) / "README.md"
    return path.read_text("utf-8") if path.is_file() else ""
