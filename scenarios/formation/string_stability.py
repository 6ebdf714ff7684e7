"""Whether what disturbs one car grows from follower to follower: ratios over a run and amplification by frequency.

Cars stand in a row: car k is held against car k - 1, whoever it follows (under a star topology all follow car 1, and
the ratios say how alike they respond). z is the error of the hand point at the follower's instants.

    gamma_k = max|z_k| / max|z_{k-1}|,   the same of root mean squares;   k = 3 ... N, as car 1 follows nobody
    |Gamma_k(j omega)| = |V_k(j omega)| / |V_{k-1}(j omega)|,   k = 2 ... N, and of Z_k, k = 3 ... N

In a chain of equal followers that know nothing but the car ahead, both quotients are the same function; that of the
speeds v, which are true states, is far less noisy. Once all are told the head's speed, the errors are what counts.

A ratio of errors that are sensor noise means nothing: it is NaN where neither exceeds `FLOOR`. Where only the own error
does, that of the car ahead is taken for `FLOOR`, so the ratio is at least what is said.

Gamma is the quotient of Fourier coefficients at the lines of a multi-sine, over whole periods after the start has died
out. The signal is periodic and all lines fit the window, so there is no leakage and no window function, and a
coefficient has no bias from averaging: for such a signal this is better than a cross-spectral estimate. Lines that were
not excited carry noise and distortion only; a line counts where the car ahead is `CLEAR` times above them, so that
noise changes the quotient by about a tenth at most. The coherence a cross-spectral estimate would show there,
snr^2/(1 + snr^2), is above 0.99.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from cosim.model.signals import Vector
from cosim.scenario.metric import Metric
from scenarios.formation.by_car import by_car, largest

FLOOR = 0.2
"""Largest error [m] of the car ahead from which on a ratio means something: receiver, filter and radio leave about 5 cm
(root mean square) of a follower at rest in its place."""
SPEED_FLOOR = 0.5
"""The same of speeds [m/s]."""
CLEAR = 10.0


def ratio_metrics(errors: Mapping[int, Vector]) -> dict[str, Metric]:
    """`car3.string_ratio_max`, `_rms` of the longitudinal error, `_norm_max`, `_norm_rms` of |z|, and the worst of all.

    `errors` are z (n, 2) [m] by car, without a car that follows nobody.
    """
    return _ratios_by_car(
        {
            "string_ratio": {k: z[:, 0] for k, z in errors.items()},
            "string_ratio_norm": {k: np.linalg.norm(z, axis=1) for k, z in errors.items()},
        },
        FLOOR,
    )


def speed_ratio_metrics(deviations: Mapping[int, Vector]) -> dict[str, Metric]:
    """`car2.speed_ratio_max`, `_rms` and the worst of all: true speeds of a car over those of the car ahead.

    `deviations` (n,) [m/s] from the speed of the formation, by car, the head included.
    """
    return _ratios_by_car({"speed_ratio": deviations}, SPEED_FLOOR)


def _ratios_by_car(signals: Mapping[str, Mapping[int, Vector]], floor: float) -> dict[str, Metric]:
    """`ratio` of signals by name and car, as `car2.NAME_max`, `car2.NAME_rms`, and the worst of all."""
    figures: dict[int, dict[str, float]] = {}
    for name, of_cars in signals.items():
        for car, own, ahead in _pairs(of_cars):
            greatest, mean = ratio(own, ahead, floor)
            figures.setdefault(car, {}).update({f"{name}_max": greatest, f"{name}_rms": mean})
    return by_car(figures, {f"{name}_{kind}": "1" for name in signals for kind in ("max", "rms")})


def _pairs(signals: Mapping[int, Vector]) -> Iterator[tuple[int, Vector, Vector]]:
    """Number, own signal and that of the car ahead, of every car with one ahead."""
    for car in sorted(signals):
        if car - 1 in signals:
            yield car, signals[car], signals[car - 1]


def ratio(own: Vector, ahead: Vector, floor: float = FLOOR) -> tuple[float, float]:
    """max|own|/max|ahead| and the quotient of the root mean squares.

    Where `ahead` never exceeds `floor`, `floor` stands for both: lower bounds. NaN where `own` does not either.
    """
    if not len(ahead) or max(np.max(np.abs(own)), np.max(np.abs(ahead))) <= floor:
        return math.nan, math.nan
    greatest, mean = np.max(np.abs(ahead)), np.sqrt(np.mean(ahead**2))
    if greatest <= floor:
        greatest = mean = floor
    return float(np.max(np.abs(own)) / greatest), float(np.sqrt(np.mean(own**2)) / mean)


def gain_metrics(
    errors: Mapping[int, Vector], speeds: Mapping[int, Vector], lines: Sequence[int], periods: int
) -> dict[str, Metric]:
    """`car2.string_gain_max` of speeds and `car3.error_gain_max` of longitudinal errors, and the worst of all.

    `errors` (n,) [m], `speeds` (n,) [m/s] by car over `periods` whole periods of the excitation; `lines` as `gains`.
    """
    figures: dict[int, dict[str, float]] = {}
    for name, signals in (("string_gain_max", speeds), ("error_gain_max", errors)):
        for car, own, ahead in _pairs(signals):
            figures.setdefault(car, {})[name] = largest(gains(own, ahead, lines, periods).tolist())
    return by_car(figures, {"string_gain_max": "1", "error_gain_max": "1"})


def gains(own: Vector, ahead: Vector, lines: Sequence[int], periods: int, clear: float = CLEAR) -> Vector:
    """|Gamma| at each line (n,), NaN where `ahead` is not `clear` times above what was not excited near it.

    `own`, `ahead` (n,) are evenly sampled over `periods` periods; `lines` are the excited multiples of the period's
    frequency. Not every multiple may be excited, unless there are several periods.
    """
    numerator, denominator = (np.fft.rfft(signal - np.mean(signal)) for signal in (own, ahead))
    bins = periods * np.asarray(lines)
    noise = _noise(np.abs(denominator), bins)
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.abs(numerator[bins]) / np.abs(denominator[bins])
    return np.where(np.abs(denominator[bins]) > clear * noise, found, np.nan)


def _noise(spectrum: Vector, bins: Vector, near: int = 6) -> Vector:
    """Root mean square of the `near` bins closest to each of `bins` that were not excited; the mean is left out."""
    free = np.setdiff1d(np.arange(1, len(spectrum)), bins)
    nearest = np.argsort(np.abs(free - bins[:, None]), axis=1, kind="stable")[:, :near]
    return np.asarray(np.sqrt(np.mean(spectrum[free[nearest]] ** 2, axis=1)))
