"""The noise generator in C: unit normals, equal to the Python form, independent between samples and seeds."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import demo_filter
import numpy as np
import pytest
from scipy import stats

from fmukit.compiling.compiler import host_platform
from fmukit.direct import normals
from fmukit.packaging.builder import library
from fmukit.packaging.codegen import generate

Draw = Callable[[int, int, int], np.ndarray]


@pytest.fixture(scope="module")
def draw(tmp_path_factory: pytest.TempPathFactory) -> Draw:
    path = tmp_path_factory.mktemp("library") / "kernel.so"
    path.write_bytes(library(generate(demo_filter.INTERFACE, demo_filter.kernel()), host_platform()))
    function = ctypes.CDLL(str(path)).fmukit_normals
    function.argtypes = [ctypes.c_int64, ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p]

    def draw(seed: int, index: int, count: int) -> np.ndarray:
        drawn = np.empty(count + 1)
        function(seed, index, count, drawn.ctypes.data)
        return drawn[:count]

    return draw


def test_equal_to_the_python_form(draw: Draw) -> None:
    for seed in (0, 1, 2, 2**31 - 1):
        for index in (0, 1, 2, 1000, 123456789):
            for count in (1, 2, 7):
                assert draw(seed, index, count).tolist() == normals(seed, index, count)


def test_unit_normal_within_a_sample_and_over_samples(draw: Draw) -> None:
    within = draw(3, 5, 20000)
    over = np.array([draw(3, index, 1)[0] for index in range(20000)])
    seeds = np.array([draw(seed, 1, 1)[0] for seed in range(20000)])
    for values in (within, over, seeds):
        assert stats.kstest(values, "norm").pvalue > 1e-3
        assert abs(np.corrcoef(values[:-1], values[1:])[0, 1]) < 4.0 / np.sqrt(len(values))
