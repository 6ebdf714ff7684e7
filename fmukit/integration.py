"""The classical Runge-Kutta method of order four, one step of x' = f(x, part).

`part` says how much of the step has gone by, 0, 1/2 or 1, for what changes during it. States may be CasADi's symbols
or numpy's arrays.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Rate = Callable[[Any, float], Any]


def rk4(f: Rate, x: Any, h: Any) -> Any:
    """x after a step of h [s]."""
    k_1, k_2, k_3, k_4 = stages(f, x, h)
    return x + h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + k_4)


def stages(f: Rate, x: Any, h: Any) -> tuple[Any, Any, Any, Any]:
    """The four rates whose mean, weighted 1, 2, 2, 1, carries x over a step of h [s]."""
    k_1 = f(x, 0.0)
    k_2 = f(x + h / 2 * k_1, 0.5)
    k_3 = f(x + h / 2 * k_2, 0.5)
    return k_1, k_2, k_3, f(x + h * k_3, 1.0)
