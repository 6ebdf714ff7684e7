"""The adaptation of the network: its gradient by finite differences, eqs (2.28), (2.29) in numpy, the step by scipy."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from adaptive_network import INPUTS, NEURONS, OUTPUTS, draw, output, rates, sigma
from scipy.integrate import solve_ivp

from fmus.controllers.adaptive_follower import network
from tests.references import adaptation

_SHAPES = [(INPUTS + 1, NEURONS), (NEURONS + 1, OUTPUTS), (INPUTS + 1, 1), (OUTPUTS, 1)]
_SYMBOLS = [ca.SX.sym(name, *shape) for name, shape in zip(("V", "W", "xbar", "e"), _SHAPES, strict=True)]
_LEARNING = ca.SX.sym("learning", 6)
_PARAMETERS = network.Learning(*ca.vertsplit(_LEARNING))
_T = ca.SX.sym("T")
_RATES = ca.Function("rates", [*_SYMBOLS, _LEARNING], list(adaptation.rates(*_SYMBOLS, _PARAMETERS)))
_ADAPT = ca.Function("adapt", [*_SYMBOLS, _LEARNING, _T], list(network.adapt(*_SYMBOLS, _PARAMETERS, _T)))
FAST = 1e9


def _seeds(count: int):
    return pytest.mark.parametrize("seed", range(count))


@_seeds(5)
def test_rates_are_the_equations_of_the_thesis(seed):
    rng = np.random.default_rng(seed)
    V, W, xbar, e = draw(rng, 5.0)
    F, G, delta_w, delta_v = rng.uniform(0.01, 3.0, 4)
    m = rng.choice([0.5, 1.0, 2.0])
    ours = _RATES(V, W, xbar, e, [F, G, delta_w, delta_v, m, FAST])
    for mine, theirs in zip(ours, rates(V, W, xbar, e, F, G, delta_w, delta_v, m), strict=True):
        np.testing.assert_allclose(mine.full(), theirs, rtol=1e-12, atol=1e-13)


@_seeds(3)
def test_without_leak_the_rates_follow_the_gradient_of_the_network(seed):
    """V' = -G d(e'y)/dV. W' = -F (d(e'y)/dW - d sigma e'), d sigma the change of sigma as V grows by itself."""
    V, W, xbar, e = draw(np.random.default_rng(seed))
    h = 1e-6

    def slope(along_V, along_W):
        ahead, behind = (output(V + s * along_V, W + s * along_W, xbar) for s in (h, -h))
        return e @ (ahead - behind) / (2 * h)

    def gradient(shape, direction):
        units = np.eye(shape[0] * shape[1]).reshape(-1, *shape)
        return np.array([slope(*direction(unit)) for unit in units]).reshape(shape)

    by_V = gradient(V.shape, lambda unit: (unit, 0 * W))
    by_W = gradient(W.shape, lambda unit: (0 * V, unit))
    growth = (sigma((1 + h) * V, xbar) - sigma((1 - h) * V, xbar)) / (2 * h)
    V_rate, W_rate = _RATES(V, W, xbar, e, [2.0, 3.0, 0.0, 0.0, 1.0, FAST])
    np.testing.assert_allclose(V_rate.full(), -3.0 * by_V, rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(W_rate.full(), -2.0 * (by_W - np.outer(growth, e)), rtol=1e-6, atol=1e-8)


def test_a_sample_tends_to_the_rates():
    V, W, xbar, e = draw(np.random.default_rng(1))
    learning = [0.57, 0.3, 0.5, 0.4, 1.0, FAST]
    errors = []
    for T in (1e-2, 1e-3, 1e-4):
        moved = [(new.full() - old) / T for new, old in zip(_ADAPT(V, W, xbar, e, learning, T), (V, W), strict=True)]
        wanted = rates(V, W, xbar, e, *learning[:5])
        errors.append(max(np.abs(a - b).max() for a, b in zip(moved, wanted, strict=True)))
    assert errors[-1] < 1e-3
    assert np.log10(errors[0] / errors[1]) > 0.9
    assert np.log10(errors[1] / errors[2]) > 0.9


def test_the_leak_of_a_sample_is_exact():
    """At a given e, and with what is taught held, W' is linear: scipy integrates the same over 2 s in one sample."""
    V, W, xbar, e = draw(np.random.default_rng(2))
    G, delta_w, delta_v = 0.0, 0.8, 0.4
    F, T = 1e-9, 2.0  # slow enough that nothing is divided; the leak is made fast by delta_w
    W_next = _ADAPT(V, W, xbar, e, [F, G, delta_w / F, delta_v, 1.0, FAST], T)[1].full()

    def rate(_t, w):
        return rates(V, w.reshape(W.shape), xbar, e, F, G, delta_w / F, delta_v, 1.0)[1].ravel()

    exact = solve_ivp(rate, (0, T), W.ravel(), rtol=1e-10, atol=1e-13).y[:, -1].reshape(W.shape)
    np.testing.assert_allclose(W_next, exact, rtol=1e-7, atol=1e-9)


@_seeds(3)
def test_what_is_learnt_changes_no_faster_than_told(seed):
    V, W, xbar, e = draw(np.random.default_rng(seed), 10.0)
    T, fastest = 1e-4, 8.0
    V_next, W_next = _ADAPT(V, W, xbar, 30 * e, [200.0, 100.0, 0.0, 0.0, 1.0, fastest], T)
    change = np.linalg.norm(output(V_next.full(), W_next.full(), xbar) - output(V, W, xbar)) / T
    assert 0.1 * fastest < change <= 1.01 * fastest


@pytest.mark.parametrize("F", [0.57, 20.0, 200.0, 1000.0])
def test_the_loop_of_samples_is_stable_for_gains_of_any_size(F):
    """e+ = e + T (-K e + nu_hat - nu), a leader at 30 m/s, 20 ms: no lag, but a period far too long for F = 1000."""
    V, _, xbar, _ = draw(np.random.default_rng(3))
    W, e, T = np.zeros((NEURONS + 1, OUTPUTS)), np.array([-10.0, 5.0]), 0.02
    for _ in range(3000):
        V, W = (new.full() for new in _ADAPT(V, W, xbar, e, [F, F / 2, 1e-3, 1e-3, 1.0, FAST], T))
        e = e + T * (-2.0 * e + output(V, W, xbar) - np.array([30.0, 0.0]))
    assert np.linalg.norm(e) < 0.1
    assert np.linalg.norm(W) < 40.0


def test_hidden_weights_start_uniform_and_the_same_everywhere():
    V = network.first_hidden_weights().full()
    assert V.shape == (INPUTS + 1, NEURONS)
    assert np.abs(V).max() < 1.0
    assert abs(V.mean()) < 3 / np.sqrt(3 * V.size)
    np.testing.assert_allclose(V[0, :2], [-0.7312715117751976, 0.6948674738744653], rtol=1e-15)
