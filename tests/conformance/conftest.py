"""The catalogue's FMUs, and a good one to break."""

from __future__ import annotations

from pathlib import Path

import pytest

from fmukit.packaging.cached import cached
from fmus.sensors import imu


@pytest.fixture(scope="session")
def good() -> Path:
    return cached(imu.COMPONENT)
