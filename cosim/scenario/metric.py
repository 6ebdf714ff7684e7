"""A figure that says how good a run was, with its unit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple


class Metric(NamedTuple):
    """`value` in SI units, NaN where there is nothing to measure; `unit` is "1" for a pure number."""

    value: float
    unit: str = "1"


Metrics = Mapping[str, Metric]
"""Metrics by name."""


def in_unit(unit: str, values: Mapping[str, float]) -> dict[str, Metric]:
    """The `values` as metrics of one unit."""
    return {name: Metric(value, unit) for name, value in values.items()}
