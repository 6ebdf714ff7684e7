"""The network with a single hidden layer and its adaptation: thesis eqs (2.26), (2.28) and (2.29).

y = W' sigma(V' xbar),  xbar (N1+1) with a leading 1,  sigma = [1; sigmoid(.)] (N2+1),
V (N1+1 x N2),  W (N2+1 x N3)
"""

from __future__ import annotations

import random
from typing import NamedTuple

import casadi as ca

N1, N2, N3 = 6, 10, 2
_SEED = 1
_SMALLEST = 1e-12


class Activation(NamedTuple):
    """a = V' xbar (N2), sigma (N2+1) and its Jacobian sigma' (N2+1 x N2)."""

    a: ca.SX
    sigma: ca.SX
    slope: ca.SX


class Learning(NamedTuple):
    """F, G, delta_w, delta_v, m, and how fast the output may change [m/s2]."""

    F: ca.SX
    G: ca.SX
    delta_w: ca.SX
    delta_v: ca.SX
    m: ca.SX
    fastest: ca.SX


def first_hidden_weights() -> ca.DM:
    """V at the start: uniform in (-1, 1) from a fixed seed, the same in every follower and on every machine."""
    drawn = random.Random(_SEED)
    return ca.DM([[drawn.uniform(-1.0, 1.0) for _ in range(N2)] for _ in range(N1 + 1)])


def activation(V: ca.SX, xbar: ca.SX) -> Activation:
    """The hidden layer at the input xbar."""
    a = V.T @ xbar
    s = 1 / (1 + ca.exp(-a))
    return Activation(a, ca.vertcat(1, s), ca.vertcat(ca.SX.zeros(1, N2), ca.diag(s * (1 - s))))


def adapt(V: ca.SX, W: ca.SX, xbar: ca.SX, e: ca.SX, learning: Learning, T: ca.SX) -> tuple[ca.SX, ca.SX]:
    """(V, W) one sample of T [s] later, at the tracking error e (N3), actual minus wanted.

    V' = -G {xbar e' W' sigma' + delta_v (1 + |e|^m) V},  W' = -F {(sigma - sigma' a) e' + delta_w (1 + |e|^m) W}

    with F and G slowed down together, so that all stays bounded for gains of any size.
    g is how fast the output answers the gradient, per error. Within a sample this acts on e itself, e+ = e - T^2 g e;
    at the end of the sample (implicit Euler) it is divided by 1 + T^2 g. And the output changes with no more than
    `fastest`: g |e| <= fastest. The leak is linear in the weights, at a given e, and solved exactly.
    """
    at, leak = activation(V, xbar), _leak(e, learning.m)
    teacher, through = _teacher(at), W.T @ at.slope
    g_V = learning.G * ca.sumsqr(xbar) * ca.sumsqr(through)
    g = g_V + learning.F * ca.fmax(ca.dot(at.sigma, teacher), 0)
    slower = ca.fmax(1 + T**2 * g, g * ca.norm_2(e) / learning.fastest)
    G, F = learning.G / slower, learning.F / slower
    V_next = _relaxed(V, -G * (xbar @ (e.T @ through)), G * learning.delta_v * leak, T)
    W_next = _relaxed(W, -F * (teacher @ e.T), F * learning.delta_w * leak, T)
    return V_next, W_next


def _relaxed(X: ca.SX, gradient: ca.SX, rate: ca.SX, T: ca.SX) -> ca.SX:
    """X' = gradient - rate X solved over T."""
    x = ca.fmax(rate * T, _SMALLEST)
    return ca.exp(-x) * X + T * (-ca.expm1(-x) / x) * gradient


def _teacher(at: Activation) -> ca.SX:
    """sigma - sigma' V' xbar (N2+1)."""
    return at.sigma - at.slope @ at.a


def _leak(e: ca.SX, m: ca.SX) -> ca.SX:
    """1 + |e|^m."""
    return 1 + ca.fmax(ca.norm_2(e), _SMALLEST) ** m
