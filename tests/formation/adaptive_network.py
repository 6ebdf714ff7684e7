"""The network and eqs (2.28), (2.29) once more, element by element in numpy."""

from __future__ import annotations

import numpy as np

INPUTS, NEURONS, OUTPUTS = 6, 10, 2


def sigma(V: np.ndarray, xbar: np.ndarray) -> np.ndarray:
    """[1; sigmoid(V' xbar)]."""
    return np.concatenate([[1.0], 1.0 / (1.0 + np.exp(-V.T @ xbar))])


def output(V: np.ndarray, W: np.ndarray, xbar: np.ndarray) -> np.ndarray:
    return W.T @ sigma(V, xbar)


def rates(V, W, xbar, e, F, G, delta_w, delta_v, m):
    """(V', W'), written out in sums."""
    s = sigma(V, xbar)[1:]
    slope, a, leak = s * (1 - s), V.T @ xbar, 1.0 + np.linalg.norm(e) ** m
    V_rate, W_rate = np.zeros_like(V), np.zeros_like(W)
    for j in range(NEURONS):
        back = slope[j] * sum(W[j + 1, i] * e[i] for i in range(OUTPUTS))
        for k in range(INPUTS + 1):
            V_rate[k, j] = -G * (xbar[k] * back + delta_v * leak * V[k, j])
    for j in range(NEURONS + 1):
        teacher = 1.0 if j == 0 else s[j - 1] - slope[j - 1] * a[j - 1]
        for i in range(OUTPUTS):
            W_rate[j, i] = -F * (teacher * e[i] + delta_w * leak * W[j, i])
    return V_rate, W_rate


def draw(rng: np.random.Generator, size: float = 1.0) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Random V, W, xbar (with its leading 1) and e."""
    V, W = rng.uniform(-1, 1, (INPUTS + 1, NEURONS)), size * rng.normal(size=(NEURONS + 1, OUTPUTS))
    return V, W, np.concatenate([[1.0], rng.uniform(-1, 1, INPUTS)]), rng.normal(size=OUTPUTS)
