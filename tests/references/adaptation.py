"""The adaptation of AdaptiveFollower's network in continuous time: thesis eqs (2.28) and (2.29)."""

from __future__ import annotations

import casadi as ca

from fmus.controllers.adaptive_follower.network import Learning, activation


def rates(V: ca.SX, W: ca.SX, xbar: ca.SX, e: ca.SX, learning: Learning) -> tuple[ca.SX, ca.SX]:
    """(V', W') at the tracking error e (N3), actual minus wanted.

    V' = -G {xbar e' W' sigma' + delta_v (1 + |e|^m) V},  W' = -F {(sigma - sigma' a) e' + delta_w (1 + |e|^m) W}
    """
    at, leak = activation(V, xbar), 1 + ca.fmax(ca.norm_2(e), 1e-12) ** learning.m
    hidden = xbar @ e.T @ W.T @ at.slope + learning.delta_v * leak * V
    output = (at.sigma - at.slope @ at.a) @ e.T + learning.delta_w * leak * W
    return -learning.G * hidden, -learning.F * output
