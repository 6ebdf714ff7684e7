"""Where on the reference the car is held to be: a memory of the reference, and how far behind it the car may fall.

The bus shows what lies ahead. A car that cannot keep time (motors lost) needs what lies behind: the last samples are
kept. When the error along the path leaves +- `trajectory.gap` the reference waits, or hurries, so that the error stays
there, and its speed comes down to that of the car: the path is then followed without its times.
"""

from __future__ import annotations

import casadi as ca

from fmus.controllers.bus import PREVIEW, PREVIEW_PERIOD, SAMPLE
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.reference.playback import lookup

PAST = 150
"""Samples kept."""
ROW = len(SAMPLE) + 1
"""Length of one of them: its time [s] from the newest sample of the bus (< 0), then x, y, course, speed, ..."""
_INPUTS = INTERFACE.names("input")
_EARLIEST, _LATEST = -1.0, 3.0  # s, limits of the delay
_SLOWEST = 1.0  # m/s, below it the reference keeps its times
_EASE = 0.5  # s of delay over which the car's speed comes to be that of the reference


def now(u: ca.MX) -> ca.MX:
    """The present sample (6) of the bus."""
    return ca.vertcat(*(u[_INPUTS.index(f"reference.{name}")] for name in SAMPLE))


def straight(sample: ca.MX, Ts: ca.MX) -> ca.MX:
    """A memory (ROW x PAST) of a car that has come straight on at constant speed."""
    times = ca.DM(range(-PAST, 0)).T * Ts
    x, y, course, speed = (sample[i] for i in range(4))
    way = speed * times
    still = ca.MX.zeros(1, PAST)
    return ca.vertcat(
        times, x + ca.cos(course) * way, y + ca.sin(course) * way, still + course, still + speed, still, still
    )


def remembered(past: ca.MX, sample: ca.MX, elapsed: ca.MX) -> ca.MX:
    """The memory with the sample before, `elapsed` [s] ago, as its newest."""
    aged = ca.vertcat(past[0, :] - elapsed, past[1:, :])
    return ca.horzcat(aged[:, 1:], ca.vertcat(-elapsed, sample))


def along(u: ca.MX, past: ca.MX, start: ca.MX, rate: ca.MX, times: ca.MX) -> ca.MX:
    """The reference (6 x times) at start + rate `times` [s] of the bus, its speed times `rate`."""
    rows, ahead = PAST + PREVIEW + 1, [PREVIEW_PERIOD * k for k in range(PREVIEW + 1)]
    columns = [ca.vertcat(past[0, :].T, ca.DM(ahead))]
    for i, name in enumerate(SAMPLE):
        names = [f"reference.{name}", *(f"preview[{k}].{name}" for k in range(1, PREVIEW + 1))]
        columns.append(ca.vertcat(past[i + 1, :].T, u[[_INPUTS.index(given) for given in names]]))
    ends = ca.vertcat(past[0, 0], ahead[-1])
    count = times.numel()
    found = lookup(count, rows)(ca.vertcat(*columns), ends, start + rate * times)
    scale = ca.vertcat(1, 1, 1, rate, rate**2, 1)
    return found * ca.repmat(scale, 1, count)


def delayed(delay: ca.MX, e_s: ca.MX, speed: ca.MX, gap: ca.MX) -> ca.MX:
    """The delay [s] that brings an error e_s [m] at `speed` back to +- gap, or the delay as near to zero as it may."""
    v = ca.fmax(speed, _SLOWEST)
    behind, ahead = delay - (e_s + gap) / v, delay - (e_s - gap) / v
    return ca.fmin(ca.fmax(ca.fmax(behind, ca.fmin(ahead, 0)), _EARLIEST), _LATEST)


def pace(delay: ca.MX, v: ca.MX, speed: ca.MX) -> ca.MX:
    """How fast the reference is gone through: 1 in time; with a delay the ratio of the speeds of car and reference."""
    ratio = ca.fmin(ca.fmax(v / ca.fmax(speed, _SLOWEST), 0.05), 2)
    part = ca.fmin(ca.fabs(delay) / _EASE, 1) * (speed > _SLOWEST)
    return 1 + part * (ratio - 1)
