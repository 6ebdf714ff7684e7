"""Where scenarios get their FMUs: from the catalogue of components, built into the user's cache when missing."""

from __future__ import annotations

from pathlib import Path

from cosim.errors import CosimError, unknown


def fmu_path(model: str) -> Path:
    """The .fmu file of the catalogue's `model`; raises CosimError if there is none or it cannot be built."""
    from fmukit.build.cache import cached  # noqa: PLC0415
    from fmukit.build.errors import BuildError  # noqa: PLC0415  (lazy: `cosim list` needs no build tools)
    from fmus import CATALOGUE  # noqa: PLC0415

    components = {component.interface.name: component for component in CATALOGUE}
    if model not in components:
        raise unknown("model", model, components)
    try:
        return cached(components[model])
    except BuildError as error:
        raise CosimError(f"cannot build {model}: {error}") from None
