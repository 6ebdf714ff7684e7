"""For test suites: `from fmukit.conformance.pytest_helper import assert_conformant`."""

from __future__ import annotations

from pathlib import Path

from fmukit.conformance.check import ALL, check
from fmukit.conformance.report import sentences


def assert_conformant(path: Path | str, groups: str = ALL, *, strict: bool = False) -> None:
    """Fail with one paragraph per rule that the FMU violates; `strict`: also per rule that is advice."""
    failures = sentences(Path(path), check(path, groups), strict=strict)
    if failures:
        raise AssertionError(failures)
