"""Scenario runs shared by the tests: each is made once."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from cosim.results.reading import Results
from cosim.run import Request, run
from scenarios import load

Run = Callable[..., tuple[dict[str, Any], Results]]


@pytest.fixture(scope="session")
def scenario_run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Run]:
    """run(name, "instance.variable=value", ..., seed=0): (summary, results) of a finished run."""

    @cache
    def made(name: str, *assignments: str, seed: int = 0) -> tuple[dict[str, Any], Results]:
        pairs = [tuple(assignment.split("=", 1)) for assignment in assignments]
        folder = Path(tmp_path_factory.mktemp(name))
        summary, results = run(Request(load(name), folder, pairs, seed))  # type: ignore[arg-type]
        assert summary["status"] == "ok", summary["reason"]
        return summary, results

    yield made
    made.cache_clear()
