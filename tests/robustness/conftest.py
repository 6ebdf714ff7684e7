"""The catalogue's FMUs, unzipped once for all tests of this folder."""

from __future__ import annotations

import zipfile
from pathlib import Path

import pytest

from fmukit.packaging.cached import cached
from fmus import CATALOGUE


@pytest.fixture(scope="session")
def unzipped(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Folder of each FMU by its name."""
    folders = {}
    for component in CATALOGUE:
        name = component.interface.name
        folders[name] = tmp_path_factory.mktemp("unzipped") / name
        with zipfile.ZipFile(cached(component)) as archive:
            archive.extractall(folders[name])
    return folders
