"""Where scenarios get their FMUs: from the catalogue of components, built into the user's cache when missing."""

from __future__ import annotations

from pathlib import Path

from cosim.errors import CosimError, because, unknown


def fmu_path(model: str) -> Path:
    """The .fmu file of the catalogue's `model`; raises CosimError if there is none or it cannot be built."""
    from fmukit.errors import BuildError  # noqa: PLC0415  (lazy: `cosim list` needs no build tools)
    from fmukit.packaging.cached import cached  # noqa: PLC0415
    from fmukit.store import cache_folder  # noqa: PLC0415
    from fmus import CATALOGUE  # noqa: PLC0415

    components = {component.interface.name: component for component in CATALOGUE}
    if model not in components:
        raise unknown("model", model, components)
    try:
        return cached(components[model])
    except BuildError as error:
        raise CosimError(f"cannot build {model}: {error}") from None
    except OSError as error:
        where = error.filename or cache_folder()
        remedy = "make room there, or set XDG_CACHE_HOME to a folder you can write into"
        raise CosimError(f"cannot keep the built {model} in {where}: {because(error)}; {remedy}") from None
