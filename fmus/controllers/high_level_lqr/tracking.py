"""Tracking errors in the frame of the path and their exactly discretised dynamics."""

from __future__ import annotations

import math

import casadi as ca

from fmukit.kernel import Parts
from fmus.cars.rotation import wrap

_TERMS = 7


def path_errors(position: ca.SX, yaw: ca.SX, velocity: ca.SX, reference: Parts, beta_r: ca.SX) -> ca.SX:
    """(e_s, e_v, e_n, e_psi) [m, m/s, m, rad]: rotated position error, speed error, yaw error to course_r - beta_r."""
    chi = reference["course"]
    dx, dy = position[0] - reference["x"], position[1] - reference["y"]
    e_s = ca.cos(chi) * dx + ca.sin(chi) * dy
    e_n = -ca.sin(chi) * dx + ca.cos(chi) * dy
    e_v = ca.sqrt(velocity[0] ** 2 + velocity[1] ** 2) - reference["speed"]
    return ca.vertcat(e_s, e_v, e_n, wrap(yaw - (chi - beta_r)))


def exact_model(v: ca.SX, curvature: ca.SX, T: float, reach: ca.SX | float = 0.0) -> tuple[ca.SX, ca.SX]:
    """Phi = exp(A T) and Gamma = int_0^T exp(A s) ds B, by the closed form of the rotation w = v kappa.

    The functions of theta = w T are entire; their series of 7 terms are exact to rounding for |theta| < 1.
    `reach` [m] adds -reach dw to e_n' (see lag.py).
    """
    theta = v * curvature * T
    cosine, sinc = _series(theta, 0), _series(theta, 1)  # cos(theta), sin(theta)/theta
    versine, residue = _series(theta, 2), _series(theta, 3)  # (1 - cos)/theta^2, (theta - sin)/theta^3
    S, C = T * sinc, T * theta * versine  # integrals of cos(w s) and sin(w s) over one period
    SS, CC = T**2 * versine, T**2 * theta * residue  # their integrals once more
    Phi, Gamma = ca.SX.eye(4), ca.SX.zeros(4, 2)
    Phi[0, :] = ca.horzcat(cosine, S, theta * sinc, v * C)
    Phi[2, :] = ca.horzcat(-theta * sinc, -C, cosine, v * S)
    Gamma[0, :], Gamma[2, :] = ca.horzcat(SS, v * CC), ca.horzcat(-CC, v * SS)
    Gamma[:, 1] -= reach * ca.vertcat(C, 0, S, 0)
    Gamma[1, 0], Gamma[3, 1] = T, T
    return ca.densify(Phi), Gamma


def _series(theta: ca.SX, order: int) -> ca.SX:
    """sum_k (-1)^k theta^(2k) / (2k + order)!, by Horner's rule."""
    total = ca.SX(0)
    for k in reversed(range(_TERMS)):
        total = 1 / math.factorial(2 * k + order) - theta**2 * total
    return total
