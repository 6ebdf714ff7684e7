"""What is taken now and then, is under way for a while, may get lost, and is reported when newest.

Pure functions over the states of one such queue; a satellite receiver's fixes and a radio's messages are both of this
kind. An item is a column of named values with two more: `taken`, its instant [s], and `good`, 0 when it gets lost.
"""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, Parts, choose

_NEVER = -1e9  # s, instant of an item that was not taken
_DUE = 1e-7  # s, tolerance when comparing times


class InFlight:
    """A queue of `capacity` items of the given sizes, newest first.

    `states` are its states: index of the period last served, number of items reported, the one reported last, (instant,
    goodness) of the newest due, and the queue. `capacity` must be two more than the longest latency over the shortest
    period: an item falls off the end when so many newer ones have been taken.
    """

    def __init__(self, capacity: int, **sizes: int) -> None:
        self.item = Layout(**sizes, taken=1, good=1)
        self.capacity = capacity
        self.states = Layout(last_index=1, count=1, reported=self.item, latest=2, queue=capacity * self.item.size)

    def empty(self) -> Parts:
        """The states before anything was taken."""
        nothing = self.item.begun({"taken": _NEVER})
        return {
            "last_index": ca.SX(-1),
            "count": ca.SX(0),
            "reported": self.item.split(nothing),
            "latest": ca.SX([_NEVER, 0]),
            "queue": ca.repmat(nothing, self.capacity),
        }

    def take(self, x: Parts, item: Parts, period: ca.SX, t: ca.SX) -> Parts:
        """Put `item` at the head of the queue when one is due at t: one in every period, from time 0 on."""
        index = ca.floor((t + _DUE) / period)
        shifted = ca.vertcat(self.item.join(item), x["queue"][: -self.item.size])
        return x | {"queue": ca.if_else(index > x["last_index"], shifted, x["queue"]), "last_index": index}

    def report(self, x: Parts, latency: ca.SX, t: ca.SX) -> Parts:
        """Report the newest good item whose latency has passed; `latest` becomes that of the newest due one."""
        reported, latest = x["reported"], x["latest"]
        for item in map(self.item.split, reversed(ca.vertsplit(x["queue"], self.item.size))):
            due = ca.logic_and(item["taken"] + latency <= t + _DUE, item["taken"] > latest[0])
            latest = ca.if_else(due, ca.vertcat(item["taken"], item["good"]), latest)
            reported = choose(ca.logic_and(due, item["good"] > 0.5), item, reported)
        count = x["count"] + (reported["taken"] > x["reported"]["taken"])
        return x | {"reported": reported, "latest": latest, "count": count}

    def newest(self, x: Parts) -> Parts:
        """The item reported last by name, all zero before any."""
        return x["reported"] | {"taken": ca.if_else(x["count"] > 0, x["reported"]["taken"], 0)}


def good(lost_share: ca.SX, outage: tuple[ca.SX, ca.SX], w: ca.SX, t: ca.SX) -> ca.SX:
    """0 inside the outage (start, duration) [s] and for a share of the items: Phi(w) is uniform on [0, 1]."""
    since = t + _DUE - outage[0]
    inside = ca.logic_and(since >= 0, since < outage[1])
    lost = 0.5 * (1 + ca.erf(w / ca.sqrt(2))) < lost_share
    return 1 - ca.logic_or(inside, lost)
