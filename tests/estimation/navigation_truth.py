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


_LAP = 16.0  # s


def _integrated(parts, t):
    """Sum of gain x pulse and of its integral; `parts` are (gain, begin, end, rise)."""
    return tuple(sum(part[0] * f(t, *part[1:]) for part in parts) for f in (_pulse, _pulse_integral))


def _weave(laps):
    """Start speed, accelerations and yaw rates of high-speed swerves, again and again."""
    signs, push, turn = (1, -1, -1, 1), [], []
    for begin in (_LAP * lap for lap in range(laps)):
        push += [(2, begin + 1.5, begin + 6, 0.5), (-3, begin + 10.5, begin + 13.5, 0.5)]
        turn += [(4 / 29 * s, begin + 2 + 2.2 * k, begin + 4.2 + 2.2 * k, 1) for k, s in enumerate(signs)]
        turn.append((3 / 29, begin + 11, begin + 15.5, 1.2))
    return 25, push, turn


def _town(_):
    """From rest through a town: corners, a swerve, straights and a stop."""
    push = [(2, 5, 11.5, 0.5), (-2, 25, 28.5, 0.5), (2, 33, 37.5, 0.5), (-2.5, 57, 63.1, 0.5), (2, 72, 78.5, 0.5)]
    push += [(-2, 95, 98.5, 0.5), (2, 104, 110.5, 0.5)]
    turn = [(0.5, 28.5, 32.1, 0.6), (0.1, 45, 47, 0.8), (-0.1, 47, 49, 0.8), (-0.5, 98.5, 102.1, 0.6)]
    turn += [(0.06, 113, 125, 1), (-0.06, 128, 140, 1)]
    return 0, push, turn


DRIVES = {"weave": _weave, "town": _town}


@cache
def motion(drive: str = "weave", laps: int = 1) -> ca.Function:
    """t -> velocity (3, world), attitude (3), body velocity, body rate, its derivative, specific force, acceleration in
    body axes (3 each)."""
    t = ca.SX.sym("t")
    d = lambda e: ca.jacobian(e, t)  # noqa: E731
    begin, push, turn = DRIVES[drive](laps)
    a_x, gained = _integrated(push, t)
    rate, course = _integrated(turn, t)
    speed = begin + gained
    a_y = speed * rate
    angles = ca.vertcat(ROLL_GAIN * a_y, -PITCH_GAIN * a_x, course - SIDESLIP_GAIN * a_y)
    velocity = ca.vertcat(speed * ca.cos(course), speed * ca.sin(course), 0)
    R = rotation_matrix(*ca.vertsplit(angles))
    spin = ca.reshape(d(ca.vec(R)), 3, 3)
    W = R.T @ spin
    omega = ca.vertcat(W[2, 1], W[0, 2], W[1, 0])
    acceleration = R.T @ d(velocity)
    force = acceleration + R.T @ ca.vertcat(0, 0, G)
    return ca.Function("motion", [t], [velocity, angles, R.T @ velocity, omega, d(omega), force, acceleration])


def rotation_matrix(phi, theta, psi):
    """Rz(psi) Ry(theta) Rx(phi) as the product of its three factors."""
    c, s = ca.cos, ca.sin
    Rx = ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, c(phi), -s(phi)), ca.horzcat(0, s(phi), c(phi)))
    Ry = ca.vertcat(ca.horzcat(c(theta), 0, s(theta)), ca.horzcat(0, 1, 0), ca.horzcat(-s(theta), 0, c(theta)))
    Rz = ca.vertcat(ca.horzcat(c(psi), -s(psi), 0), ca.horzcat(s(psi), c(psi), 0), ca.horzcat(0, 0, 1))
    return Rz @ Ry @ Rx


@cache
def truth(duration: float = 16.0, step: float = T, drive: str = "weave", laps: int = 1) -> dict[str, np.ndarray]:
    """Signals by port name, one value per sample."""
    moves = motion(drive, laps)
    times = np.arange(round(duration / step) + 1) * step
    nodes, weights = np.polynomial.legendre.leggauss(5)
    inner = (times[:-1, None] + step * (nodes + 1) / 2).ravel()
    between = moves(inner[None, :])[0].full().reshape(3, -1, 5) @ weights * step / 2
    position = np.hstack([np.zeros((3, 1)), np.cumsum(between, axis=1)])
    _, angles, velocity, omega, epsilon, force, acceleration = (block.full() for block in moves(times[None, :]))
    signals = {"time": times} | dict(zip(("truth.roll", "truth.pitch", "truth.yaw"), angles, strict=True))
    vectors = {"position": position, "velocity": velocity, "angular_rate": omega}
    vectors |= {"angular_acceleration": epsilon, "specific_force": force, "acceleration": acceleration}
    signals |= {f"truth.{n}.{a}": row for n, block in vectors.items() for a, row in zip("xyz", block, strict=True)}
    return signals | suspension(signals, TYRE)


def straight(times: np.ndarray, command: np.ndarray, lag: float) -> dict[str, np.ndarray]:
    """Signals by port name of a car that neither leans nor turns, whose speed (n,) follows `command` (n,), held from
    sample to sample, with a `lag` [s], so that its acceleration jumps; in closed form."""
    step, speed, way = times[1] - times[0], [command[0]], [0.0]
    decay = np.exp(-step / lag)
    for held in command[:-1]:
        way.append(way[-1] + held * step + (speed[-1] - held) * lag * (1 - decay))
        speed.append(held + (speed[-1] - held) * decay)
    rate, level = (command - speed) / lag, np.full(len(times), G)
    signals = {"time": times, "truth.specific_force.z": level, "truth.position.x": np.array(way)}
    signals |= {"truth.velocity.x": np.array(speed), "truth.acceleration.x": rate, "truth.specific_force.x": rate}
    names = [f"truth.{n}.{a}" for n in ("position", "velocity") for a in "xyz"]
    return dict.fromkeys((*names, "truth.yaw", "truth.roll", "truth.pitch"), 0 * times) | signals


def suspension(
    signals: dict[str, np.ndarray], tyre: float, load: float = 0.0, place=(0, 0, 0)
) -> dict[str, np.ndarray]:
    """Travel of the four wheels when the tyres, of stiffness `tyre`, carry the quasi-static load transfer.

    A `load` [kg] at `place` from O1, which is at the height of the centre of gravity, leans on them as well.
    """
    f_x, f_y = signals["truth.specific_force.x"], signals["truth.specific_force.y"]
    leverage, (x, y, z) = MASS * HEIGHT, place
    leverage += load * (HEIGHT + z)
    moment_y, moment_x = leverage * f_y - load * G * y, -leverage * f_x + load * G * x
    roll = np.tan(signals["truth.roll"] - moment_y / (tyre * TRACK**2))
    pitch = np.tan(signals["truth.pitch"] - moment_x / (tyre * WHEELBASE**2))
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


def navigate(seed, imu, gps, estimator, *, settings=None, signals=None, outages=()):
    """Filter outputs over the manoeuvre: sensors with `seed`, `settings` per instance; components with kernels.

    No fix is taken within `outages`, pairs of begin and end [s].
    """
    signals, settings = signals or truth(), settings or {}
    inertial, held = sensed(seed, imu, gps, settings=settings, signals=signals)
    held = without(held, signals["time"], outages)
    speed = float(signals["truth.velocity.x"][0])
    start = {"initial.speed": speed, "initial.position.x": 0.0} | settings.get("filter", {})
    return run(estimator[0], signals | inertial | held, start, kernel=estimator[1]) | held


def sensed(seed, imu, gps, *, settings, signals):
    """What the inertial unit reads, and what the receiver, which runs half as often, holds."""
    inertial = run(imu[0], signals, {"seed": 2 * seed} | settings.get("imu", {}), kernel=imu[1])
    satellite = run(gps[0], signals, {"seed": 2 * seed + 1} | settings.get("gps", {}), every=2, kernel=gps[1])
    return inertial, {name: np.repeat(values, 2)[: len(signals["time"])] for name, values in satellite.items()}


def without(held, times, outages):
    """The receiver's outputs without the fixes taken within the outages: the last one before is held, not valid."""
    lost = np.zeros(len(times), dtype=bool)
    for begin, end in outages:
        lost |= (held["gps.time"] >= begin - 1e-9) & (held["gps.time"] < end - 1e-9)
    index = np.maximum.accumulate(np.where(lost, 0, np.arange(len(times))))
    kept = {name: values[index] for name, values in held.items()}
    return kept | {"gps.valid": np.where(lost, 0.0, kept["gps.valid"])}


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
