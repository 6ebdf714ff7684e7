"""The signal vector: the values of all signals at one time, and what each of its elements is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
"""Values of signals at one time, or of one signal over time."""


@dataclass(frozen=True, slots=True)
class Signal:
    """One element of the signal vector: an output of an instance, or an input of it that events change.

    In the vector every number is a double, whatever its `type`; Strings are kept beside it.
    """

    instance: str
    variable: str
    unit: str | None
    type: str = "Real"

    @property
    def name(self) -> str:
        return f"{self.instance}.{self.variable}"
