"""Where on the reference the car is held to be: a memory of its path, and how far behind it the car may fall.

The bus shows what lies ahead. A car that cannot keep time (motors lost) needs what lies behind: samples of the bus are
kept about `SPACING` apart along the path, whatever the sampling period. When the error along the path leaves
+- `trajectory.gap` the reference waits, or hurries, so that the error stays there, and its speed comes down to that of
the car: the path is then followed without its times.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Signals
from fmus.clip import clip
from fmus.controllers.bus import PREVIEW, PREVIEW_PERIOD, SAMPLE
from fmus.controllers.reference.playback import lookup

PAST = 400
"""Samples kept."""
SPACING = 1.5
"""Distance [m] between them where the reference is played smoothly; else they are closer."""
ROW = len(SAMPLE) + 1
"""Length of one of them: its time [s] from the newest sample of the bus (< 0), then x, y, course, speed, ..."""
FASTEST = 2.0
"""Largest pace."""
SEEN = PREVIEW * PREVIEW_PERIOD
"""Length of the preview [s]."""
_LONGEST = 1.0  # s between two samples kept
_MISFIT = 0.05  # m: between two samples kept, the mean of their speeds tells the distance so well
_SLOWEST = 1.0  # m/s, below it the reference keeps its times
_LEAST = 1e-3  # pace that stands for none: it is divided by
_EASE = 0.5  # s of delay over which the car's speed comes to be that of the reference


@dataclass(frozen=True, slots=True)
class Passage:
    """How the reference is gone through: from `start` [s] of the bus at `pace`, which falls by `braking` [1/s]; known
    up to `end` [s], and straight on after it.
    """

    start: ca.MX
    pace: ca.MX
    braking: ca.MX
    end: ca.MX


def now(u: Signals) -> ca.MX:
    """The present sample (6) of the bus."""
    return u.vector("reference", SAMPLE)


def straight(sample: ca.MX) -> ca.MX:
    """A memory (ROW x PAST) of a car that has come straight on at constant speed."""
    x, y, course, speed = (sample[i] for i in range(4))
    times = ca.DM(range(-PAST, 0)).T * (SPACING / ca.fmax(speed, _SLOWEST))
    way = speed * times
    still = ca.MX.zeros(1, PAST)
    return ca.vertcat(
        times, x + ca.cos(course) * way, y + ca.sin(course) * way, still + course, still + speed, still, still
    )


def aged(past: ca.MX, elapsed: ca.MX) -> ca.MX:
    """The memory `elapsed` [s] later."""
    return ca.vertcat(past[0, :] - elapsed, past[1:, :])


def remembered(past: ca.MX, sample: ca.MX, elapsed: ca.MX) -> tuple[ca.MX, ca.MX]:
    """The memory with the sample before, `elapsed` [s] ago, as its newest, and 1 if its oldest was dropped for it.

    The newest so far is dropped instead when its neighbours tell the path without it.
    """
    rows, newest = aged(past, elapsed), ca.vertcat(-elapsed, sample)
    spared = _joined(rows[:, -2], newest)
    return ca.horzcat(ca.if_else(spared, rows[:, :-1], rows[:, 1:]), newest), 1 - spared


def _joined(left: ca.MX, right: ca.MX) -> ca.MX:
    """1 if nothing need be kept between two rows."""
    way, time = ca.norm_2(right[1:3] - left[1:3]), right[0] - left[0]
    misfit = way - 0.5 * time * (left[4] + right[4])
    return (way <= SPACING) * (time <= _LONGEST) * (ca.fabs(misfit) <= _MISFIT)


def along(u: Signals, past: ca.MX, passage: Passage, times: ca.MX) -> ca.MX:
    """The reference (6 x times) as it is gone through, `times` [s] from now."""
    ahead = [PREVIEW_PERIOD * k for k in range(PREVIEW + 1)]
    columns = [ca.vertcat(past[0, :].T, ca.DM(ahead))]
    for i, name in enumerate(SAMPLE):
        names = [f"reference.{name}", *(f"preview[{k}].{name}" for k in range(1, PREVIEW + 1))]
        columns.append(ca.vertcat(past[i + 1, :].T, u.pick(names)))
    pace, b = passage.pace, passage.braking
    t = ca.fmin(times, pace / ca.fmax(b, _LEAST))
    ends = ca.vertcat(past[0, 0], passage.end)
    found = lookup(times.numel(), PAST + PREVIEW + 1)(
        ca.vertcat(*columns), ends, passage.start + pace * t - 0.5 * b * t**2
    )
    paces = ca.fmax(pace - b * times, 0).T
    speed, acceleration = found[3, :], found[4, :] * paces**2 - found[3, :] * b * (paces > 0)
    return ca.vertcat(found[:3, :], speed * paces, acceleration, found[5, :])


def delayed(delay: ca.MX, e_s: ca.MX, speed: ca.MX, gap: ca.MX) -> ca.MX:
    """The delay [s] that brings an error e_s [m] at `speed` back to +- gap, or the delay as near to zero as it may."""
    v = ca.fmax(speed, _SLOWEST)
    behind, ahead = delay - (e_s + gap) / v, delay - (e_s - gap) / v
    return ca.fmax(behind, ca.fmin(ahead, 0))


def within(delay: ca.MX, past: ca.MX, read: ca.MX, speed: ca.MX, reach: float) -> tuple[ca.MX, ca.MX]:
    """The delay within what is known of the path, and 1 if the car is within it too.

    Behind the memory ends, ahead the preview, of which the first `read` [s] have passed and the last `reach` [s] times
    the largest pace are the horizon's. Before a reference that stands, it is straight on.
    """
    earliest, latest = read + FASTEST * reach - SEEN, -past[0, 0]
    return clip(delay, earliest, latest), (delay <= latest) * ca.logic_or(delay >= earliest, speed <= _SLOWEST)


def pace(delay: ca.MX, v: ca.MX, speed: ca.MX, lost: ca.MX, slow: ca.MX) -> ca.MX:
    """How fast the reference is gone through: 1 in time; with a delay the ratio of the speeds of car and reference.

    That ratio too when the car is `slow` for want of friction.
    """
    ratio = clip(v / ca.fmax(speed, _SLOWEST), ca.if_else(lost, _LEAST, 0.05), FASTEST)
    part = ca.fmax(ca.fmin(ca.fabs(delay) / _EASE, 1), slow) * (speed > _SLOWEST)
    return 1 + part * (ratio - 1)


def braking(deceleration: ca.MX, v: ca.MX, speed: ca.MX) -> ca.MX:
    """Loss of pace [1/s] that slows the reference down by `deceleration` [m/s2], by less for a car almost at rest."""
    return deceleration * clip(v / _SLOWEST, 0, 1) / ca.fmax(speed, _SLOWEST)
