"""From what the receiver reports to the rows of the history that its parts belong to."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals, block, slots
from fmus.estimator.history import ROWS
from fmus.estimator.interface import INTERFACE
from fmus.estimator.records import DRIFT, PLACE, SENSED

FIX = Layout(place=PLACE, drift=DRIFT, place_age=1, drift_age=1)
"""A fix and the ages of its two parts, in samples before now."""
_LEAST_SHARE = 0.1  # of the accuracy that a receiver reports, which is white at least
_PERIODS = 1e-6  # tolerance of a time stamp, in sampling periods


@block(p=slots(INTERFACE, "parameter"), u=slots(INTERFACE, "input"), t=1)
def reported(p: Signals, u: Signals, t: ca.SX) -> Parts:
    """The newest fix as a column of FIX; `t` [s] is the filter's own time.

    Ages are counted from the time stamps, so that no period has to divide another. A part belongs to the row that ends
    nearest to its instant.
    """
    place_age, place_delay = _row(t - u["gps.time"], p["sample_period"])
    drift_age, drift_delay = _row(t - u["gps.time"] + u["gps.velocity_delay"], p["sample_period"])
    heading = _variance(u, "heading", p["noise.gps_heading"], ca.SX(0))
    place = {
        "position": u.vector("gps.position", "xy"),
        "position_variance": _variance(u, "position", p["noise.gps_position"], p["noise.gps_correlated"]),
        "heading": u["gps.heading"],
        "heading_variance": heading,
        "place_delay": place_delay,
    }
    drift = {
        "velocity": u.vector("gps.velocity", "xy"),
        "velocity_variance": _variance(u, "velocity", p["noise.gps_velocity"], ca.SX(0)),
        "alone": heading <= 0,
        "drift_delay": drift_delay,
    }
    return {"place": place, "drift": drift, "place_age": place_age, "drift_age": drift_age}


def _row(age: ca.SX, period: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Age of the nearest row [samples], not before now, and its end less the instant [s]."""
    samples = age / period
    nearest = ca.fmax(ca.floor(samples + 0.5 - _PERIODS), 0)
    delay = ca.fmax(samples - nearest, -0.5) * period
    return nearest, delay


def _variance(u: Signals, part: str, assumed: ca.SX, slow: ca.SX) -> ca.SX:
    """Variance of the white error of a part: as reported less its slow share, as assumed if not; 0 if not valid."""
    told = u[f"gps.{part}_accuracy"]
    white = ca.fmax(told**2 - slow**2, (_LEAST_SHARE * told) ** 2)
    return ca.if_else(u[f"gps.{part}_valid"] > 0.5, ca.if_else(told > 0, white, assumed**2), 0)


def in_reach(fix: Parts, checkpoint_age: ca.MX) -> ca.MX:
    """Of heading, position and velocity (3): 1 where its row is not older than the checkpoint."""
    place, drift = fix["place_age"] <= checkpoint_age, fix["drift_age"] <= checkpoint_age
    return ca.vertcat(place, place, drift)


def present(fix: Parts) -> ca.MX:
    """Of heading, position and velocity (3): 1 where the fix has it."""
    place, drift = fix["place"], fix["drift"]
    return ca.vertcat(place["heading_variance"], place["position_variance"], drift["velocity_variance"]) > 0


def put(rows: ca.MX, fix: Parts, checkpoint_age: ca.MX, doubt: ca.MX) -> ca.MX:
    """`rows` (ROW.size x ROWS) with those parts of a fix that are within reach."""
    ages = ca.DM(list(range(ROWS - 1, -1, -1))).T
    blocks, first, marked = [rows[: SENSED.size, :]], SENSED.size, ca.MX(1, ROWS)
    for name, layout in (("place", PLACE), ("drift", DRIFT)):
        here = ca.logic_and(ages == fix[f"{name}_age"], fix[f"{name}_age"] <= checkpoint_age)
        old = rows[first : first + layout.size, :]
        blocks.append(old * ca.repmat(1 - here, layout.size, 1) + ca.mtimes(layout.join(fix[name]), here))
        first, marked = first + layout.size, ca.fmax(marked, here)
    return ca.vertcat(*blocks, ca.fmax(rows[first:, :], doubt * marked))
