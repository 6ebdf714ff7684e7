"""A strapdown navigation filter in three dimensions, with error states: the reference for NavigationFilter.

It shares nothing with that filter: attitude is a rotation matrix, its error a small rotation of the world frame,
position and velocity are those of the inertial unit in the world, vertical ones included. It knows the sensors' true
noise, sees every fix at the instant at which it was taken, and sees neither suspension nor wheels. States of the
error: position, velocity, rotation, biases of gyroscope and accelerometer, slow error of the receiver (3 each).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

P, V, A, G, F, C = (slice(3 * k, 3 * k + 3) for k in range(6))
N = 18
_GRAVITY = np.array([0.0, 0.0, -9.81])


@dataclass(frozen=True)
class Noise:
    """True data of the sensors: densities and walks of the unit, turn-on biases, receiver; SI units."""

    gyroscope: float
    gyroscope_walk: float
    gyroscope_bias: float
    accelerometer: float
    accelerometer_walk: float
    accelerometer_bias: float
    position: float
    slow: float
    slow_time: float
    velocity: float
    heading: float
    vertical: float = 1.5


def noise_of(imu: Mapping[str, float], gps: Mapping[str, float]) -> Noise:
    """That of sensors with these parameters."""
    return Noise(
        imu["gyroscope.noise_density"],
        imu["gyroscope.bias_walk"],
        imu["gyroscope.turn_on_bias"],
        imu["accelerometer.noise_density"],
        imu["accelerometer.bias_walk"],
        imu["accelerometer.turn_on_bias"],
        gps["position.noise"],
        gps["position.correlated_noise"],
        gps["position.correlation_time"],
        gps["velocity.noise"],
        gps["heading.noise"] / gps["antenna.baseline"],
    )


@dataclass
class Strapdown:
    """Mean (p, v, R, biases, slow error) and covariance of its error."""

    noise: Noise
    lever: np.ndarray
    p: np.ndarray = field(default_factory=lambda: np.zeros(3))
    v: np.ndarray = field(default_factory=lambda: np.zeros(3))
    R: np.ndarray = field(default_factory=lambda: np.eye(3))
    b_g: np.ndarray = field(default_factory=lambda: np.zeros(3))
    b_a: np.ndarray = field(default_factory=lambda: np.zeros(3))
    c: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        n = self.noise
        scale = np.array([1, 1, n.vertical])
        std = [3 * [1e3], 3 * [30.0], [0.03, 0.03, 3.0], 3 * [n.gyroscope_bias], 3 * [n.accelerometer_bias]]
        self.cov = np.diag(np.concatenate([*std, scale * n.slow]) ** 2)
        self._slow = scale * n.slow

    def propagate(self, rate: np.ndarray, force: np.ndarray, T: float) -> None:
        """Through T [s] with the mean readings of that time."""
        n, omega, f = self.noise, rate - self.b_g, force - self.b_a
        push = self.R @ rotation(omega * T / 2) @ f
        Phi, decay = np.eye(N), np.exp(-T / n.slow_time)
        Phi[P, V], Phi[V, A], Phi[V, F], Phi[A, G] = T * np.eye(3), -T * cross(push), -T * self.R, -T * self.R
        Phi[P, A], Phi[P, F], Phi[V, G] = T / 2 * Phi[V, A], T / 2 * Phi[V, F], -T / 2 * Phi[V, A] @ self.R * T
        Phi[C, C] = decay * np.eye(3)
        Q = np.zeros((N, N))
        Q[V, V], Q[A, A] = n.accelerometer**2 * T * np.eye(3), n.gyroscope**2 * T * np.eye(3)
        Q[G, G], Q[F, F] = n.gyroscope_walk**2 * T * np.eye(3), n.accelerometer_walk**2 * T * np.eye(3)
        Q[C, C] = np.diag(self._slow**2 * (1 - decay**2))
        Q[P, P], Q[P, V] = Q[V, V] * T**2 / 3, Q[V, V] * T / 2
        Q[V, P] = Q[P, V]
        self.cov = Phi @ self.cov @ Phi.T + Q
        self.p, self.v, self.R = self.moved(rate, force, T)
        self.c = decay * self.c

    def moved(self, rate: np.ndarray, force: np.ndarray, T: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, velocity and rotation a time T later."""
        omega = rate - self.b_g
        a = self.R @ rotation(omega * T / 2) @ (force - self.b_a) + _GRAVITY
        return self.p + T * self.v + T**2 / 2 * a, self.v + T * a, self.R @ rotation(omega * T)

    def see_position(self, z: np.ndarray, sigma: float | None = None) -> float:
        """Position of the antenna (3); returns the NIS of its horizontal part."""
        arm = self.R @ self.lever
        H = np.zeros((3, N))
        H[:, P], H[:, A], H[:, C] = np.eye(3), -cross(arm), np.eye(3)
        return self._update(z - self.p - arm - self.c, H, self._scaled(sigma or self.noise.position))

    def see_velocity(self, z: np.ndarray, rate: np.ndarray, sigma: float | None = None) -> float:
        """Velocity of the antenna (3) while the unit turns at the measured `rate`."""
        spin = self.R @ np.cross(rate - self.b_g, self.lever)
        H = np.zeros((3, N))
        H[:, V], H[:, A], H[:, G] = np.eye(3), -cross(spin), self.R @ cross(self.lever)
        return self._update(z - self.v - spin, H, np.full(3, (sigma or self.noise.velocity) ** 2))

    def see_heading(self, z: float, sigma: float | None = None) -> float:
        """Yaw angle."""
        psi, tan = np.arctan2(self.R[1, 0], self.R[0, 0]), -self.R[2, 0] / np.hypot(self.R[0, 0], self.R[1, 0])
        H = np.zeros((1, N))
        H[0, A] = [tan * np.cos(psi), tan * np.sin(psi), 1]
        gap = (z - psi + np.pi) % (2 * np.pi) - np.pi
        return self._update(np.array([gap]), H, np.array([(sigma or self.noise.heading) ** 2]))

    def _scaled(self, sigma: float) -> np.ndarray:
        return sigma**2 * np.array([1, 1, self.noise.vertical**2])

    def _update(self, gap: np.ndarray, H: np.ndarray, R: np.ndarray) -> float:
        S = H @ self.cov @ H.T + np.diag(R)
        K = np.linalg.solve(S, H @ self.cov).T
        rest = np.eye(N) - K @ H
        self.cov = rest @ self.cov @ rest.T + K @ np.diag(R) @ K.T
        x = K @ gap
        self.p, self.v, self.R = self.p + x[P], self.v + x[V], rotation(x[A]) @ self.R
        self.b_g, self.b_a, self.c = self.b_g + x[G], self.b_a + x[F], self.c + x[C]
        flat = slice(0, min(2, len(gap)))
        return float(gap[flat] @ np.linalg.solve(S[flat, flat], gap[flat]))


def cross(a: np.ndarray) -> np.ndarray:
    """[a]x."""
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def rotation(turn: np.ndarray) -> np.ndarray:
    """The matrix of the rotation vector (Rodrigues)."""
    angle, K = float(np.linalg.norm(turn)), cross(turn)
    if angle < 1e-8:
        return np.eye(3) + K
    matrix: np.ndarray = np.eye(3) + np.sin(angle) / angle * K + (1 - np.cos(angle)) / angle**2 * K @ K
    return matrix
