"""The published test-drive car in numpy, written as printed there: sideslip positive to the right."""

from __future__ import annotations

import numpy as np
from numpy import arctan, cos, sin

M, G, L_F, L_R, I_ZZ = 1239.0, 9.81, 1.19016, 1.37484, 1752.0
C_W, RHO, A = 0.3, 1.249512, 1.4378946874


def gerdts(z: np.ndarray, u: np.ndarray) -> np.ndarray:
    """(x, y, v, beta, psi, w_z, delta), (w_delta, U_F, U_R) -> derivative."""
    _, _, v, beta, psi, w_z, delta = z
    alpha_f = delta - arctan((L_F * w_z - v * sin(beta)) / (v * cos(beta)))
    alpha_r = arctan((L_R * w_z + v * sin(beta)) / (v * cos(beta)))
    F_sf, F_sr = pacejka(10.96, 1.3, 4560.4, -0.5, alpha_f), pacejka(12.67, 1.3, 3947.81, -0.5, alpha_r)
    s = v * 3.6 / 100
    f_r = 0.009 + 0.002 * s + 0.0003 * s**4
    F_lf = u[1] - f_r * M * G * L_R / (L_F + L_R)
    F_lr = u[2] - f_r * M * G * L_F / (L_F + L_R)
    F_ax = 0.5 * C_W * RHO * A * v**2
    return np.array(
        [
            v * cos(psi - beta),
            v * sin(psi - beta),
            ((F_lr - F_ax) * cos(beta) + F_lf * cos(delta + beta) - F_sr * sin(beta) - F_sf * sin(delta + beta)) / M,
            w_z
            - ((F_lr - F_ax) * sin(beta) + F_lf * sin(delta + beta) + F_sr * cos(beta) + F_sf * cos(delta + beta))
            / (M * v),
            w_z,
            (F_sf * L_F * cos(delta) - F_sr * L_R + F_lf * L_F * sin(delta)) / I_ZZ,
            u[0],
        ]
    )


def pacejka(B: float, C: float, D: float, E: float, alpha: float) -> float:
    """Lateral force [N]."""
    return float(D * sin(C * arctan(B * alpha - E * (B * alpha - arctan(B * alpha)))))
