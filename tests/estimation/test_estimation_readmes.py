"""The examples in the READMEs of the sensors and of the filter run as printed."""

import doctest
from pathlib import Path

import pytest

FMUS = Path(__file__).parents[2] / "fmus"


@pytest.mark.parametrize("folder", ["sensors/imu", "sensors/gps", "estimator"])
def test_examples(folder):
    outcome = doctest.testfile(str(FMUS / folder / "README.md"), module_relative=False, encoding="utf-8")
    assert outcome.attempted > 0
    assert outcome.failed == 0
