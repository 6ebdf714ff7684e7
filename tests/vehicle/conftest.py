"""A fast car for long runs: the kernel compiled once per session, or casadi's own machine without a compiler."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Mapping

import pytest
from vehicle_car import Car, compiled

from fmukit.kernel import Kernel
from fmus.vehicle16dof import COMPONENT


@pytest.fixture(scope="session")
def kernel(tmp_path_factory: pytest.TempPathFactory) -> Kernel:
    plain = COMPONENT.kernel()
    compiler = os.environ.get("CC") or shutil.which("cc")
    return compiled(plain, compiler, tmp_path_factory.mktemp("plant")) if compiler else plain


@pytest.fixture
def car(kernel: Kernel) -> Callable[..., Car]:
    """car(parameters, inputs) -> Car."""

    def make(parameters: Mapping[str, float] | None = None, inputs: Mapping[str, float] | None = None) -> Car:
        return Car(COMPONENT, parameters, inputs, kernel=kernel)

    return make
