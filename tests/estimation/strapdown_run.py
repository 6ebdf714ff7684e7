"""The reference filter over the same readings as NavigationFilter, and the errors of both."""

from __future__ import annotations

from copy import copy

import numpy as np

from tests.references.strapdown import Strapdown, noise_of

AXES = "xyz"


def start_values(component, overrides):
    """The parameters of a sensor by name."""
    starts = {v.name: v.start for v in component.interface.select("parameter")}
    return starts | overrides


def reference(inertial, held, times, imu, gps):
    """Position (2) of O1 and velocity (2) of it in the level frame at all `times`, (samples x 4)."""
    place = np.array([imu[f"imu.position.{axis}"] for axis in AXES])
    antenna = np.array([gps[f"antenna.position.{axis}"] for axis in AXES])
    rate = np.array([inertial[f"gyroscope.{axis}"] for axis in AXES]).T
    force = np.array([inertial[f"accelerometer.{axis}"] for axis in AXES]).T
    fixes, filter_ = _fixes(held, times), Strapdown(noise_of(imu, gps), antenna - place)
    found = np.empty((len(times), 4))
    for k in range(len(times)):
        if k:
            filter_.propagate((rate[k] + rate[k - 1]) / 2, force[k], times[k] - times[k - 1])
        if k in fixes:
            position, velocity, heading = fixes[k]
            filter_.see_heading(heading)
            filter_.see_position(position)
            filter_.see_velocity(velocity, rate[k])
        found[k] = _at_o1(filter_, place, rate[k])
    return found


def reference_of_late_fixes(inertial, held, times, imu, gps, least_speed=3.0):
    """As `reference`, told each fix only when it is reported, of a receiver with one antenna.

    Velocity and position are used at their own instants, in this order; the first course above `least_speed` [m/s] is
    the heading. Between reports the mean is carried on from the last fix.
    """
    place = np.array([imu[f"imu.position.{axis}"] for axis in AXES])
    antenna = np.array([gps[f"antenna.position.{axis}"] for axis in AXES])
    rate = np.array([inertial[f"gyroscope.{axis}"] for axis in AXES]).T
    force = np.array([inertial[f"accelerometer.{axis}"] for axis in AXES]).T
    step, base, at, aligned = times[1] - times[0], Strapdown(noise_of(imu, gps), antenna - place), 0, False
    ahead, ahead_at, found = copy(base), 0, np.full((len(times), 5), np.nan)
    for k in range(len(times)):
        if k and held["gps.fix_count"][k] > held["gps.fix_count"][k - 1] and held["gps.valid"][k] > 0.5:
            instants = held["gps.time"][k] - np.array([held["gps.velocity_delay"][k], 0.0])
            scale = held["gps.velocity_accuracy"][k] / gps["velocity.noise"]
            for part, index in zip(("velocity", "position"), np.round(instants / step).astype(int), strict=True):
                at = _carry(base, rate, force, at, index, step, full=True)
                seen = np.array([held[f"gps.{part}.{axis}"][k] for axis in AXES])
                if part == "position":
                    base.see_position(seen, scale * gps["position.noise"])
                    continue
                if held["gps.velocity_valid"][k] < 0.5 or not (aligned or np.hypot(*seen[:2]) > least_speed):
                    continue
                if not aligned:
                    base.see_heading(np.arctan2(seen[1], seen[0]), 0.1)
                aligned = True
                base.see_velocity(seen, rate[at], scale * gps["velocity.noise"])
            ahead, ahead_at = copy(base), at
        ahead_at = _carry(ahead, rate, force, ahead_at, k, step, full=False)
        if aligned:
            found[k] = [*_at_o1(ahead, place, rate[k]), np.arctan2(ahead.R[1, 0], ahead.R[0, 0])]
    return found


def _carry(filter_, rate, force, begin, end, step, *, full):
    """Move the filter, or only its mean, through the samples from `begin` to `end`; returns where it is."""
    for k in range(begin + 1, end + 1):
        mean = (rate[k] + rate[k - 1]) / 2, force[k]
        if full:
            filter_.propagate(*mean, step)
        else:
            filter_.p, filter_.v, filter_.R = filter_.moved(*mean, step)
    return max(begin, end)


def _fixes(held, times):
    """(position, velocity, heading) by the sample at which they were taken; these are samples of the drive."""
    step, fixes = times[1] - times[0], {}
    for k in np.flatnonzero((np.diff(held["gps.fix_count"], prepend=0.0) > 0) & (held["gps.valid"] > 0.5)):
        vectors = [np.array([held[f"gps.{name}.{axis}"][k] for axis in AXES]) for name in ("position", "velocity")]
        fixes[round(held["gps.time"][k] / step)] = (*vectors, held["gps.heading"][k])
    return fixes


def _at_o1(filter_, place, rate):
    """Of the reference: position of O1 in the world, its velocity turned back by the yaw angle."""
    R = filter_.R
    p = filter_.p - R @ place
    v = filter_.v - R @ np.cross(rate - filter_.b_g, place)
    psi = np.arctan2(R[1, 0], R[0, 0])
    c, s = np.cos(psi), np.sin(psi)
    return np.array([p[0], p[1], c * v[0] + s * v[1], -s * v[0] + c * v[1]])


def levelled(vx, vy, roll, pitch):
    """Horizontal velocity in the level frame of a body velocity (vx, vy, vz) that has no vertical part."""
    vz = (np.sin(pitch) * vx - np.cos(pitch) * np.sin(roll) * vy) / (np.cos(pitch) * np.cos(roll))
    x = np.cos(pitch) * vx + np.sin(pitch) * (np.sin(roll) * vy + np.cos(roll) * vz)
    return np.array([x, np.cos(roll) * vy - np.sin(roll) * vz]).T


def errors_of(found, signals):
    """Lengths of the errors of position and velocity (samples x 2)."""
    true = np.column_stack(
        [
            signals["truth.position.x"],
            signals["truth.position.y"],
            levelled(*(signals[f"truth.{n}"] for n in ("velocity.x", "velocity.y", "roll", "pitch"))),
        ]
    )
    gap = found - true
    return np.column_stack([np.hypot(gap[:, 0], gap[:, 1]), np.hypot(gap[:, 2], gap[:, 3])])


def ours(y):
    """What NavigationFilter found, as `reference` gives it."""
    names = ("velocity.x", "velocity.y", "roll", "pitch")
    velocity = levelled(*(y[f"estimate.{name}"] for name in names))
    return np.column_stack([y["estimate.position.x"], y["estimate.position.y"], velocity])
