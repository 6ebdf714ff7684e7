"""How a quadratic program is solved: OSQP's settings that matter in a control loop."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields


@dataclass(frozen=True, slots=True)
class QpSettings:
    """Settings of one solver, fixed when its C code is made; see the README of `fmukit.qp` for what they do to speed.

    rho                penalty of the first call, and after a call without a solution
    sigma, alpha       regularisation and relaxation of the iteration
    absolute, relative tolerances of both residuals (largest entry), in the units of the caller's scaled problem
    infeasible         tolerance of the proofs that there is no solution
    iterations         most iterations of a call
    check              iterations between two looks at the residuals
    adapt              iterations between two adaptions of rho, a multiple of `check`; 0: never
    """

    rho: float = 0.1
    sigma: float = 1e-6
    alpha: float = 1.6
    absolute: float = 1e-4
    relative: float = 1e-4
    infeasible: float = 1e-5
    iterations: int = 1000
    check: int = 10
    adapt: int = 10

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"QpSettings: {field.name} is {value}; it must be finite and not negative")
        for name in ("rho", "sigma", "infeasible", "iterations", "check"):
            if not getattr(self, name):
                raise ValueError(f"QpSettings: {name} is 0; it must be positive")
        if not 0.0 < self.alpha < 2.0:
            raise ValueError(f"QpSettings: alpha is {self.alpha}; it must lie between 0 and 2")
        if not self.absolute + self.relative:
            raise ValueError("QpSettings: absolute and relative are both 0; one of them must be positive")
        if self.adapt % self.check:
            raise ValueError(f"QpSettings: adapt is {self.adapt}, not a multiple of check = {self.check}")

    def osqp(self) -> dict[str, object]:
        """The same in OSQP's names. Scaling is off: it would make a result depend on the data before."""
        return {
            "rho": self.rho,
            "sigma": self.sigma,
            "alpha": self.alpha,
            "eps_abs": self.absolute,
            "eps_rel": self.relative,
            "eps_prim_inf": self.infeasible,
            "eps_dual_inf": self.infeasible,
            "max_iter": self.iterations,
            "check_termination": self.check,
            "check_dualgap": False,
            "adaptive_rho": int(self.adapt > 0),
            "adaptive_rho_interval": self.adapt,
            "scaling": 0,
            "polishing": False,
            "warm_starting": True,
            "verbose": False,
        }
