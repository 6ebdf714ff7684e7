"""A chain of adaptive followers on a straight in plain numpy: thesis eqs (2.26), (2.28), (2.29) along one axis.

    v_c = -K z + W' sigma(V' xbar),  (tau_r + h) v_r' = v_c - v_r,  tau v' = v_r - v,  z = p - p_ahead + d + h v_r

The hidden weights start as those of AdaptiveFollower. All followers at once: V (followers, 7, 10), W (followers, 11).
Signals are deviations from a mean speed; the inputs of the network and the learnt speed are not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from chain_model import Drive, Motion

from fmus.controllers.adaptive_follower.network import first_hidden_weights

NEURONS = 10


@dataclass(frozen=True)
class Adaptive:
    gain: float = 2.0
    output: float = 0.57
    hidden: float = 0.3
    leak: float = 1e-3
    headway: float = 0.0
    reference_time: float = 0.1
    lag: float = 0.2
    mean: float = 25.0

    def hidden_weights(self) -> np.ndarray:
        return np.array(first_hidden_weights())

    @property
    def integral(self) -> float:
        """K_i = F sigma' (sigma - sigma' a), how fast the output answers the error while W holds the bias only."""
        a = self.hidden_weights().T @ _inputs(np.zeros(1), np.full(1, self.mean))[0]
        s = 1 / (1 + np.exp(-a))
        return float(self.output * (1 + s @ (s - s * (1 - s) * a)))


def transfer(law: Adaptive, omega: np.ndarray) -> np.ndarray:
    """p_k / p_{k-1} for small motions, with K_i of the bias alone:

    1/Gamma = 1 + h s (1 + tau s) + s^2 (1 + tau s)(1 + (tau_r + h) s)/(K s + K_i)
    """
    s, h = 1j * omega, law.headway
    car, reference = 1 + law.lag * s, 1 + (law.reference_time + h) * s
    return 1 / (1 + h * s * car + s**2 * car * reference / (law.gain * s + law.integral))


def _inputs(z: np.ndarray, v: np.ndarray) -> np.ndarray:
    """xbar (followers, 7) on a straight: 1, tanh(z/5), 0, sin 0, cos 0, v/30, 0."""
    one, zero = np.ones_like(z), np.zeros_like(z)
    return np.stack((one, np.tanh(z / 5), zero, zero, one, v / 30, zero), -1)


def simulate(law: Adaptive, head: Motion, followers: int, stop: float, step: float = 0.02) -> Drive:
    """Everybody starts in its place at the mean speed; the network is advanced by the explicit Euler method."""
    p, v = np.zeros(followers), np.zeros(followers)
    reference = np.zeros(followers)
    V = np.repeat(law.hidden_weights()[None], followers, 0)
    W = np.zeros((followers, NEURONS + 1))
    W[:, 0] = law.mean
    time, rows = step * np.arange(round(stop / step)), []
    for t in time:
        ahead, head_speed = head(t)
        z = p - np.concatenate(([ahead], p[:-1])) + law.headway * reference
        rows.append((np.append(ahead, p), np.append(head_speed, v), z))
        xbar = _inputs(z, law.mean + v)
        V, W, learnt = _learn(law, V, W, xbar, z, step)
        wanted = -law.gain * z + learnt - law.mean
        share = 1 - np.exp(-step / (law.reference_time + law.headway))
        reference = reference + share * (wanted - reference)
        v_next = reference + (v - reference) * np.exp(-step / law.lag) if law.lag else reference
        p, v = p + step * 0.5 * (v + v_next), v_next
    return Drive.of(time, rows)


def _learn(
    law: Adaptive, V: np.ndarray, W: np.ndarray, xbar: np.ndarray, z: np.ndarray, step: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """V and W a step later, and the output."""
    a = np.einsum("fij,fi->fj", V, xbar)
    s = 0.5 * (1 + np.tanh(0.5 * a))
    slope, one = s * (1 - s), np.ones((len(z), 1))
    leak = law.leak * (1 + np.abs(z))
    teacher = np.hstack((one, s - slope * a))
    through = W[:, 1:] * slope
    V_next = V - step * law.hidden * (np.einsum("fi,fj->fij", xbar, z[:, None] * through) + leak[:, None, None] * V)
    W_next = W - step * law.output * (teacher * z[:, None] + leak[:, None] * W)
    return V_next, W_next, np.einsum("fj,fj->f", W_next, np.hstack((one, s)))
