"""What the benchmark of the solvers inside the FMU reads of a run, and when."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import qp_in_fmu
from cosim.results.summary import InstanceSummary
from cosim.run.request import Request


class _Columns:
    """Columns of a file that goes with its folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def samples(self, instance: str, name: str) -> np.ndarray:
        assert self._folder.is_dir(), "the results are read after they are gone"
        return np.array([1e-6, 3e-6] if name.endswith(".time") else [4.0, 6.0])


def test_results_are_read_while_their_folder_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    def run(request: Request) -> SimpleNamespace:
        spent = InstanceSummary("MpcAllocator", 0.02, 1000, 1.0)
        return SimpleNamespace(summary=SimpleNamespace(instances={"mpc": spent}), results=_Columns(request.folder))

    monkeypatch.setattr(qp_in_fmu, "run", run)
    found, exchange = qp_in_fmu.measure(rounds=2)
    assert {name: (seen.time.mean, seen.iterations) for name, seen in found.items()} == {
        "solver": (pytest.approx(2.0), 5.0),
        "allocation": (pytest.approx(2.0), 5.0),
    }
    assert exchange == pytest.approx(1000.0)
