"""What is made of a series of values: its largest, its root mean square, its mean."""

from __future__ import annotations

import math

import numpy as np

from cosim.model.signals import Vector


def wrap(angle: Vector) -> Vector:
    """Into [-pi, pi)."""
    return np.asarray((angle + np.pi) % (2.0 * np.pi) - np.pi)


def peak(values: Vector) -> float:
    """Largest magnitude; 0 without values."""
    return float(np.max(np.abs(values), initial=0.0))


def largest(values: Vector) -> float:
    """Largest magnitude; NaN without values."""
    return peak(values) if len(values) else math.nan


def rms(values: Vector) -> float:
    """Root of the mean square; NaN without values."""
    return float(np.sqrt(np.mean(values**2))) if len(values) else math.nan


def mean(values: Vector) -> float:
    """Arithmetic mean; NaN without values."""
    return float(np.mean(values)) if len(values) else math.nan
