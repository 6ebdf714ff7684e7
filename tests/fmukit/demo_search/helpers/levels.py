"""The table: piecewise constant, packed into a list of fixed length."""

from __future__ import annotations

from ..shape import ROWS


def packed(table):
    flat = [value for row in table for value in row]
    return [float(len(table)), *flat, *[0.0] * (2 * ROWS - len(flat))]


def level(d, t):
    rows = [(d[1 + 2 * k], d[2 + 2 * k]) for k in range(int(d[0]))]
    return next((value for time, value in reversed(rows) if time <= t + 1e-9), 0.0)
