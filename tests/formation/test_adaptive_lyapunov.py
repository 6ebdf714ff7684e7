"""L = |e|^2/2 + |W~|^2/(2 F) + |V~|^2/(2 G): its rate, and the bound outside of which it falls.

The derivation is in docs/studies/adaptive-follower.md. The leader moves as an ideal network with constant weights W*,
V* has it, up to a known bounded error. Runs start far outside the bound, which shows that it is not vacuous; leaks so
large that it is near pull weights back by themselves, so that the gradients show in the rate only.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
import pytest
from adaptive_loop import Unicycle, estimate, pose
from adaptive_network import INPUTS, NEURONS, OUTPUTS, output, sigma
from scipy.integrate import solve_ivp

from fmukit.direct import Direct
from fmus.controllers.adaptive_follower import COMPONENT, model, network
from tests.references import adaptation
from tests.references.loop import rotation

_SHAPES = [(INPUTS + 1, NEURONS), (NEURONS + 1, OUTPUTS), (INPUTS + 1, 1), (OUTPUTS, 1)]
_SYMBOLS = [ca.SX.sym(name, *shape) for name, shape in zip(("V", "W", "xbar", "e"), _SHAPES, strict=True)]
_LEARNING = ca.SX.sym("learning", 6)
_RATES = ca.Function(
    "rates", [*_SYMBOLS, _LEARNING], list(adaptation.rates(*_SYMBOLS, network.Learning(*ca.vertsplit(_LEARNING))))
)


@dataclass(frozen=True)
class Ideal:
    """Gains, leaks and ideal weights of one run; `epsilon` bounds what the ideal network does not know [m/s]."""

    K: float
    F: float
    G: float
    delta_w: float
    delta_v: float
    W: np.ndarray
    V: np.ndarray
    epsilon: float

    def L(self, e: np.ndarray, W: np.ndarray, V: np.ndarray) -> float:
        hidden = np.sum((V - self.V) ** 2) / (2 * self.G) if self.G else 0.0
        return float(e @ e / 2 + np.sum((W - self.W) ** 2) / (2 * self.F) + hidden)

    def L_rate(self, e: np.ndarray, W: np.ndarray, V: np.ndarray, xbar: np.ndarray, epsilon: np.ndarray) -> float:
        """L' as the derivation has it before any inequality: -K |e|^2 + e'w and what the leaks take."""
        off_W, off_V = W - self.W, V - self.V
        s = sigma(V, xbar)
        slope = np.vstack([np.zeros(NEURONS), np.diag(s[1:] * (1 - s[1:]))])
        remainder = sigma(self.V, xbar) - s + slope @ off_V.T @ xbar
        w = off_W.T @ slope @ self.V.T @ xbar - self.W.T @ remainder - epsilon
        leak = self.delta_w * np.sum(off_W * W) + (self.delta_v * np.sum(off_V * V) if self.G else 0.0)
        return float(-self.K * e @ e + e @ w - (1 + np.linalg.norm(e)) * leak)

    def bound(self, X: float) -> tuple[float, float]:
        """(c_1, c_2) of L' <= -c_1 L + c_2 with |xbar| <= X."""
        W2, V2 = np.sum(self.W**2), np.sum(self.V**2)
        B = self.delta_w * W2 + self.delta_v * V2
        c_W2, c_V2 = X**2 * V2 / 16, X**2 * W2 / 16
        C = self.epsilon + c_W2 / (2 * self.delta_w) + c_V2 / (2 * self.delta_v) + B / 2
        return min(self.K, self.F * self.delta_w, self.G * self.delta_v), C**2 / (2 * self.K) + B / 2


def drawn(seed: int) -> tuple[Ideal, np.random.Generator]:
    rng = np.random.default_rng(seed)
    K = rng.uniform(1.0, 4.0)
    weights = rng.normal(size=(NEURONS + 1, OUTPUTS)), rng.normal(size=(INPUTS + 1, NEURONS))
    W, V = (size * w / np.linalg.norm(w) for size, w in zip(rng.uniform(0.5, 2.0, 2), weights, strict=True))
    return Ideal(K, K**2 / 7, K**2 / 14, *rng.uniform(0.5, 1.5, 2), W, V, rng.uniform(0.0, 0.5)), rng


def law_level(ideal: Ideal, rng: np.random.Generator, duration: float):
    """e' = -w S e - K e + nu_hat - nu and the rates of the thesis, integrated by scipy.

    Times and rows of (e, W, V, |xbar|, L), L by its own rate from its first value on.
    """
    p = rng.uniform(0.3, 2.0, 5)
    phase = rng.uniform(0, 2 * np.pi, 2)
    learning = [ideal.F, ideal.G, ideal.delta_w, ideal.delta_v, 1.0, 1e9]

    def split(s):
        return s[:2], s[2:24].reshape(NEURONS + 1, OUTPUTS), s[24:94].reshape(INPUTS + 1, NEURONS)

    def xbar(t, e):
        theta = p[0] * np.sin(p[1] * t)
        own = [0.7 + 0.3 * np.sin(p[2] * t), 0.2 * np.sin(p[3] * t)]
        return np.array([1, *np.tanh(e / 5), np.sin(theta), np.cos(theta), *own])

    def rate(t, s):
        e, W, V = split(s)
        x = xbar(t, e)
        epsilon = ideal.epsilon * np.array([np.cos(p[4] * t + phase[0]), np.sin(p[4] * t + phase[0])])
        e_rate = -ideal.K * e - 0.2 * np.array([-e[1], e[0]]) + output(V, W, x) - output(ideal.V, ideal.W, x) - epsilon
        V_rate, W_rate = _RATES(V, W, x, e, learning)
        L_rate = ideal.L_rate(e, W, V, x, epsilon)
        return np.concatenate([e_rate, W_rate.full().ravel(), V_rate.full().ravel(), [L_rate]])

    start = np.concatenate([40 * rng.normal(size=2), 10 * rng.normal(size=22), 3 * rng.normal(size=70)])
    if not ideal.G:
        start[24:] = ideal.V.ravel()
    start = np.append(start, ideal.L(*split(start)))
    times = np.linspace(0, duration, 400)
    rows = solve_ivp(rate, (0, duration), start, t_eval=times, rtol=1e-7, atol=1e-8).y.T
    return times, [(*split(s), float(np.linalg.norm(xbar(t, s[:2]))), s[-1]) for t, s in zip(times, rows, strict=True)]


@pytest.mark.parametrize("seed", range(6))
def test_l_falls_outside_the_ultimate_bound(seed):
    ideal, rng = drawn(seed)
    times, rows = law_level(ideal, rng, duration=12.0)
    c_1, c_2 = ideal.bound(max(X for *_, X, _ in rows))
    L, ultimate = np.array([ideal.L(e, W, V) for e, W, V, *_ in rows]), c_2 / c_1
    assert L[0] > 10 * ultimate
    outside = L[:-1] > ultimate
    assert outside.sum() > 20
    assert (np.diff(L)[outside] < 0).all()
    envelope = ultimate + (L[0] - ultimate) * np.exp(-c_1 * times)
    assert (L / envelope <= 1 + 1e-6).all()
    assert np.linalg.norm(rows[-1][0]) < np.sqrt(2 * max(envelope[-1], ultimate))


@pytest.mark.parametrize("hidden", [False, True])
@pytest.mark.parametrize("leaks", [0.0, 1e-3])
def test_l_changes_exactly_as_the_analysis_says(hidden, leaks):
    """Without leaks, error of the network and hidden layer L(t) - L(0) = -K int |e|^2: gradients of another size or
    sign would leave part of e'(nu_hat - nu).
    """
    ideal, rng = drawn(7)
    ideal = replace(ideal, G=ideal.G * hidden, delta_w=leaks, delta_v=leaks, epsilon=0.3 * hidden)
    if not hidden:
        ideal = replace(ideal, V=0.0 * ideal.V)  # sigma = 1/2 throughout, sigma' V' xbar = 0
    _, rows = law_level(ideal, rng, duration=8.0)
    L, told = np.array([ideal.L(*row[:3]) for row in rows]), np.array([row[-1] for row in rows])
    np.testing.assert_allclose(L, told, atol=1e-4 * L[0])
    assert told[-1] < 0.9 * told[0]


def rate_and_ceiling(seed: int, direction: float) -> tuple[float, float]:
    """(L', what the analysis allows) at a random state with small leaks; `direction` -1 learns the wrong way."""
    ideal, rng = drawn(seed)
    ideal = replace(ideal, delta_w=1e-3, delta_v=1e-3)
    e, W_off, V_off, x = (rng.normal(size=n) for n in (2, (NEURONS + 1, OUTPUTS), (INPUTS + 1, NEURONS), INPUTS))
    W, V, xbar = ideal.W + 3 * W_off, ideal.V + 0.05 * V_off, np.concatenate([[1.0], x])
    learning = [ideal.F, ideal.G, ideal.delta_w, ideal.delta_v, 1.0, 1e9]
    V_rate, W_rate = (direction * rate.full() for rate in _RATES(V, W, xbar, e, learning))
    e_rate = -ideal.K * e + output(V, W, xbar) - output(ideal.V, ideal.W, xbar) + ideal.epsilon * e / np.linalg.norm(e)
    L_rate = e @ e_rate + np.sum(3 * W_off * W_rate) / ideal.F + np.sum(0.05 * V_off * V_rate) / ideal.G
    size_e, size_W, size_V, X = (np.linalg.norm(v) for v in (e, 3 * W_off, 0.05 * V_off, xbar))
    c_W, c_V = X * np.linalg.norm(ideal.V) / 4, X * np.linalg.norm(ideal.W) / 4
    B = ideal.delta_w * np.sum(ideal.W**2) + ideal.delta_v * np.sum(ideal.V**2)
    leak = ideal.delta_w * size_W**2 + ideal.delta_v * size_V**2 - B
    ceiling = -ideal.K * size_e**2 + size_e * (ideal.epsilon + c_W * size_W + c_V * size_V) - (1 + size_e) / 2 * leak
    return L_rate, ceiling


def test_the_rate_of_l_is_what_the_analysis_says_at_any_state():
    """The inequality before the leaks are used up: it holds at small leaks too, and not for the opposite sign."""
    right, wrong = (np.array([rate_and_ceiling(seed, sign) for seed in range(300)]) for sign in (1.0, -1.0))
    assert (right[:, 0] <= right[:, 1]).all()
    assert (wrong[:, 0] > wrong[:, 1]).mean() > 0.1


def output_weights(follower: Direct) -> np.ndarray:
    return np.array(model.STATES.split(ca.DM(follower.x))["W"]).reshape((NEURONS + 1, OUTPUTS), order="F")


FREE = {  # no limits: what the analysis speaks of
    **{"limit.speed": 1e9, "limit.acceleration": 1e9, "limit.deceleration": 1e9, "limit.friction": 1e9},
    **{"limit.curvature": 1e9, "limit.yaw_acceleration": 1e9, "adaptation.fastest": 1e9, "catch_up.distance": 1e9},
    **{"realise.speed_time": 0.0, "adaptation.hidden": 0.0},
}


def kernel_level(ideal: Ideal, seed: int, samples: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The kernel itself every millisecond, G = 0, behind a leader with nu = W*' sigma(V*' xbar) + eps and V* = V.

    Per sample e (samples, 2), L, and L by its own rate from its first value on.
    """
    rng, T, r = np.random.default_rng(seed), 1e-3, np.array([-12.0, 4.0])
    parameters = {"gain": ideal.K, "adaptation.output": ideal.F, "leak.output": ideal.delta_w, "sample_period": T}
    follower = Direct(COMPONENT, {**parameters, **FREE})
    a = follower.p[follower.interface.names("parameter").index("hand.distance")]
    car = Unicycle(x=-60.0 - 20.0 * rng.random(), y=-40.0 * rng.random(), v=20.0)
    leader, errors, L, rates = Unicycle(), [], [], []
    for k in range(samples):
        follower.set({**pose(leader), **estimate(car), "formation.x": r[0], "formation.y": r[1]})
        hand, wanted = car.place(np.array([a, 0.0])), leader.place(r + np.array([a, 0.0]))
        e, z = rotation(leader.yaw).T @ (hand - wanted), rotation(car.yaw).T @ (hand - wanted)
        theta = leader.yaw - car.yaw
        xbar = np.array([1, *np.tanh(z / 5), np.sin(theta), np.cos(theta), car.v / 30, car.w])
        before = output_weights(follower)
        follower.sample()
        W, epsilon = 0.5 * (before + output_weights(follower)), ideal.epsilon * np.array([np.cos(0.5 * k * T), 0.0])
        errors.append(e)
        L.append(ideal.L(e, W, ideal.V))
        rates.append(ideal.L_rate(e, W, ideal.V, xbar, epsilon))
        nu = output(ideal.V, ideal.W, xbar) + epsilon
        turning = nu[1] / (r[0] + a)
        leader.drive(nu[0] + turning * r[1], turning, 0.0, T)
        car.drive(follower["command.speed"], follower["command.yaw_rate"], 0.0, T)
        assert follower["saturation.speed"] + follower["saturation.yaw_rate"] == 0.0
    L, rates = np.array(L[1:]), np.array(rates[1:])  # before the first sample the weights are not yet the start values
    told = L[0] + T * np.concatenate([[0.0], np.cumsum(0.5 * (rates[1:] + rates[:-1]))])
    return np.array(errors), L, told


@pytest.mark.parametrize(("seed", "leak"), [(0, 0.0), (1, 1e-3)])
def test_l_of_the_fmu_changes_as_the_analysis_says_and_the_place_is_learnt(seed, leak):
    """And the error gets far below |nu|/K = 6 m, which it would be with weights that only leak away."""
    rng = np.random.default_rng(seed)
    W = np.vstack([[24.0, 0.0], 0.3 * rng.normal(size=(NEURONS, OUTPUTS))])
    ideal = Ideal(4.0, 16 / 7, 0.0, leak, leak, W, network.first_hidden_weights().full(), 0.2)
    e, L, told = kernel_level(ideal, seed, 4000)
    np.testing.assert_allclose(L, told, atol=0.005 * L[0])
    assert L[-1] < 0.5 * L[0]
    assert np.hypot(*e[-1]) < 0.1
