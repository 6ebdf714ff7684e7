"""The demo FMUs obey every rule about archive and description."""

from __future__ import annotations

from pathlib import Path

import pytest

from fmukit.conformance.pytest_helper import assert_conformant


@pytest.mark.parametrize("model", ["DemoSpring", "DemoFilter"])
def test_demo_obeys_the_reading_rules(demo_folder: Path, model: str) -> None:
    assert_conformant(demo_folder / f"{model}.fmu", "AX", strict=True)
