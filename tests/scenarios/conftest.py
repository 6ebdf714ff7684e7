"""Scenarios run and configured for the tests."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from scenario_types import Configured, Run

from cosim.engine.loader import Loader
from cosim.engine.models import find
from cosim.model.configuration import Configuration
from cosim.model.parsing import parse_assignments
from cosim.run import prepare
from cosim.run.request import Request
from cosim.run.running import Finished, run
from cosim.scenario.discovery import load


@pytest.fixture(scope="session")
def scenario_run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Run]:
    """scenario_run(name, "instance.variable=value", ..., seed=0, status="ok"): a run with that end, made once."""

    @cache
    def made(name: str, *assignments: str, seed: int = 0, status: str = "ok") -> Finished:
        folder = Path(tmp_path_factory.mktemp(name))
        finished = run(Request(load(name), folder, parse_assignments(assignments), seed))
        assert finished.summary.status == status, finished.summary.reason
        return finished

    yield made
    made.cache_clear()


@pytest.fixture(scope="session")
def configured() -> Iterator[Configured]:
    """configured(name, "instance.variable=value", ...): the values of the scenario's system before the start."""
    with Loader(find) as loader:

        def made(name: str, *assignments: str) -> Configuration:
            return prepare.configured(Request(load(name), Path(), parse_assignments(assignments)), loader).configuration

        yield made
