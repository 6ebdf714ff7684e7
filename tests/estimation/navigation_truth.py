"""True motion for the sensor and filter tests, and kernels run over whole input histories.

The motion is a closed form of time: speed and course are integrals of quintic blends, sideslip, roll and pitch are
proportional to the accelerations; the position is integrated by Gauss quadrature between samples.
"""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np

from fmukit.direct import Direct, normals

G, T = 9.81, 0.005
ROLL_GAIN, PITCH_GAIN, SIDESLIP_GAIN = 0.011, 0.005, -0.004
MASS, HEIGHT, TRACK, WHEELBASE, TYRE = 1500.0, 0.54, 1.5, 2.7, 200e3


def _blend(x):
    x = ca.fmax(0, ca.fmin(1, x))
    return x**3 * (10 - 15 * x + 6 * x**2)


def _blend_integral(x):
    inside = ca.fmax(0, ca.fmin(1, x))
    return inside**4 * (2.5 - 3 * inside + inside**2) + ca.fmax(0, x - 1)


def _pulse(t, a, b, r):
    return _blend((t - a) / r) - _blend((t - b + r) / r)


def _pulse_integral(t, a, b, r):
    return r * (_blend_integral((t - a) / r) - _blend_integral((t - b + r) / r))


def _weave(pulse, t):
    signs = (1, -1, -1, 1)
    return sum(s * pulse(t, 2 + 2.2 * k, 4.2 + 2.2 * k, 1) for k, s in enumerate(signs)) + 0.75 * pulse(
        t, 11, 15.5, 1.2
    )


@cache
def motion() -> ca.Function:
    """t -> velocity (3, world), attitude (3), body velocity, body rate, its derivative, specific force (3 each)."""
    t = ca.SX.sym("t")
    d = lambda e: ca.jacobian(e, t)  # noqa: E731
    speed = 25 + 2 * _pulse_integral(t, 1.5, 6, 0.5) - 3 * _pulse_integral(t, 10.5, 13.5, 0.5)
    course = 4 / 29 * _weave(_pulse_integral, t)
    a_x = 2 * _pulse(t, 1.5, 6, 0.5) - 3 * _pulse(t, 10.5, 13.5, 0.5)
    a_y = speed * 4 / 29 * _weave(_pulse, t)
    angles = ca.vertcat(ROLL_GAIN * a_y, -PITCH_GAIN * a_x, course - SIDESLIP_GAIN * a_y)
    velocity = ca.vertcat(speed * ca.cos(course), speed * ca.sin(course), 0)
    R = rotation_matrix(*ca.vertsplit(angles))
    spin = ca.reshape(d(ca.vec(R)), 3, 3)
    W = R.T @ spin
    omega = ca.vertcat(W[2, 1], W[0, 2], W[1, 0])
    force = R.T @ (d(velocity) + ca.vertcat(0, 0, G))
    return ca.Function("motion", [t], [velocity, angles, R.T @ velocity, omega, d(omega), force])


def rotation_matrix(phi, theta, psi):
    """Rz(psi) Ry(theta) Rx(phi) as the product of its three factors."""
    c, s = ca.cos, ca.sin
    Rx = ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, c(phi), -s(phi)), ca.horzcat(0, s(phi), c(phi)))
    Ry = ca.vertcat(ca.horzcat(c(theta), 0, s(theta)), ca.horzcat(0, 1, 0), ca.horzcat(-s(theta), 0, c(theta)))
    Rz = ca.vertcat(ca.horzcat(c(psi), -s(psi), 0), ca.horzcat(s(psi), c(psi), 0), ca.horzcat(0, 0, 1))
    return Rz @ Ry @ Rx


@cache
def truth(duration: float = 16.0, step: float = T) -> dict[str, np.ndarray]:
    """Signals by port name, one value per sample."""
    times = np.arange(round(duration / step) + 1) * step
    nodes, weights = np.polynomial.legendre.leggauss(5)
    inner = (times[:-1, None] + step * (nodes + 1) / 2).ravel()
    between = motion()(inner[None, :])[0].full().reshape(3, -1, 5) @ weights * step / 2
    position = np.hstack([np.zeros((3, 1)), np.cumsum(between, axis=1)])
    _, angles, velocity, omega, epsilon, force = (block.full() for block in motion()(times[None, :]))
    signals = {"time": times} | dict(zip(("truth.roll", "truth.pitch", "truth.yaw"), angles, strict=True))
    vectors = {"position": position, "velocity": velocity, "angular_rate": omega}
    vectors |= {"angular_acceleration": epsilon, "specific_force": force}
    signals |= {f"truth.{n}.{a}": row for n, block in vectors.items() for a, row in zip("xyz", block, strict=True)}
    return signals | suspension(signals, TYRE)


def suspension(signals: dict[str, np.ndarray], tyre: float) -> dict[str, np.ndarray]:
    """Travel of the four wheels when the tyres, of stiffness `tyre`, carry the quasi-static load transfer."""
    f_x, f_y = signals["truth.specific_force.x"], signals["truth.specific_force.y"]
    transfer_y, transfer_x = MASS * HEIGHT * f_y / (2 * TRACK), -MASS * HEIGHT * f_x / (2 * WHEELBASE)
    roll = np.tan(signals["truth.roll"] - 2 * transfer_y / tyre / TRACK)
    pitch = np.tan(signals["truth.pitch"] - 2 * transfer_x / tyre / WHEELBASE)
    side, end = roll * TRACK / 2, pitch * WHEELBASE / 2
    corners = {"fl": end - side, "fr": end + side, "rl": -end - side, "rr": -end + side}
    return {f"suspension_travel.{wheel}": travel for wheel, travel in corners.items()}


def run(component, signals, parameters=None, every: int = 1, kernel=None) -> dict[str, np.ndarray]:
    """Outputs of a sampled component fed with `signals`, one sample per `every` values, as arrays by name."""
    names, known = component.interface.names("input"), set(signals)
    u = np.array([signals[n][::every] if n in known else 0 * signals["time"][::every] for n in names])
    start = Direct(component, parameters, dict(zip(names, u[:, 0], strict=True)), kernel=kernel)
    count, noise = u.shape[1], component.interface.noise
    seed = int((parameters or {}).get("seed", 1))
    w = np.array([normals(seed, k + 1, noise) for k in range(count)]).T if noise else np.zeros((0, count))
    y = _loop(start, u, w, signals["time"][::every])
    return dict(zip(component.interface.names("output"), y, strict=True))


CHUNK = 100
_LOOPS: dict[int, ca.Function] = {}


def _loop(start: Direct, u: np.ndarray, w: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Outputs (ports x samples), CHUNK samples per call; the last chunk is filled up with copies of the last sample."""
    count = u.shape[1]
    chunks, x = np.minimum(np.arange(-(-count // CHUNK) * CHUNK), count - 1).reshape(-1, CHUNK), start.x
    blocks = []
    for k in chunks:
        states, y = _accumulated(start.kernel.step)(x, start.p, start.d, u[:, k], w[:, k], t[None, k])
        x = states[:, -1]
        blocks.append(y.full())
    return np.hstack(blocks)[:, :count]


def _accumulated(step: ca.Function) -> ca.Function:
    """(x0, p, d, u, w, t) -> all x, all y."""
    key = step.__hash__()
    if key not in _LOOPS:
        p, d, u, x, w, t = a = [ca.MX.sym(step.name_in(i), step.sparsity_in(i)) for i in range(6)]
        _LOOPS[key] = ca.Function("one", [x, p, d, u, w, t], step(*a)).mapaccum(CHUNK)
    return _LOOPS[key]


def navigate(seed, imu, gps, estimator, *, settings=None, signals=None):
    """Filter outputs over the manoeuvre: sensors with `seed`, `settings` per instance; components with kernels."""
    signals, settings = signals or truth(), settings or {}
    inertial = run(imu[0], signals, {"seed": 2 * seed} | settings.get("imu", {}), kernel=imu[1])
    satellite = run(gps[0], signals, {"seed": 2 * seed + 1} | settings.get("gps", {}), every=2, kernel=gps[1])
    held = {name: np.repeat(values, 2)[: len(signals["time"])] for name, values in satellite.items()}
    start = {"initial.speed": 25.0, "initial.position.x": 0.0} | settings.get("filter", {})
    return run(estimator[0], signals | inertial | held, start, kernel=estimator[1]) | held


def navigate_at(periods, seed, imu, gps, estimator, *, signals):
    """Filter outputs when imu, gps and filter run at `periods` (three whole numbers of ms); `signals` are 1 ms apart.

    Each reads the newest of what it takes, as in the master. The fix count that the filter saw is among the outputs.
    """
    sensors, held = (imu, gps), {}
    for k, (component, kernel), period in zip((0, 1), sensors, periods, strict=False):
        settings = {"seed": 2 * seed + k, "sample_period": period / 1000}
        y = run(component, signals, settings, every=period, kernel=kernel)
        held |= {name: np.repeat(values, period)[: len(signals["time"])] for name, values in y.items()}
    start = {"initial.speed": 25.0, "initial.position.x": 0.0, "sample_period": periods[2] / 1000}
    y = run(estimator[0], signals | held, start, every=periods[2], kernel=estimator[1])
    return y | {"gps.fix_count": held["gps.fix_count"][:: periods[2]]}
