"""Roads for tests: closed circuits with hairpins, chicanes and a crossing, made of straights and arcs."""

from __future__ import annotations

import numpy as np

from fmus.planner.path_road import PathRoad

CORNERS = {
    "chicane": [(0, 0), (150, 0), (165, 14), (180, 0), (300, 0), (300, 90), (120, 40), (0, 60)],
    "eight": [(0, 0), (180, 120), (250, 60), (180, 0), (0, 120), (-70, 60)],
}
"""Corners [m] of circuits; `eight` crosses itself."""


def rounded(corners: list[tuple[float, float]], radius: float = 15.0, spacing: float = 5.0) -> np.ndarray:
    """Points (n, 2) at equal distances along the closed polygon with its corners rounded."""
    V = np.array(corners, dtype=float)
    pieces = []
    for before, corner, after in zip(np.roll(V, 1, 0), V, np.roll(V, -1, 0), strict=True):
        into, out = (corner - before) / np.hypot(*(corner - before)), (after - corner) / np.hypot(*(after - corner))
        angle = np.arctan2(into[0] * out[1] - into[1] * out[0], into @ out)
        reach = 0.49 * min(np.hypot(*(corner - before)), np.hypot(*(after - corner)))
        r = min(radius, reach / np.tan(abs(angle) / 2))
        left = np.sign(angle) * np.array([-into[1], into[0]])
        centre = corner - r * np.tan(abs(angle) / 2) * into + r * left
        turn = np.linspace(0, angle, 40)[:, None]
        arm = -r * left
        pieces.append(centre + np.cos(turn) * arm + np.sin(turn) * np.array([-arm[1], arm[0]]))
    line = np.vstack([*pieces, pieces[0][:1]])
    s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = np.linspace(0, s[-1], round(s[-1] / spacing) + 1)[:-1]
    return np.column_stack([np.interp(at, s, line[:, j]) for j in (0, 1)])


def circuit(name: str, *, noise: float = 0.0, backwards: bool = False) -> PathRoad:
    """The closed road with widths that vary about 5 m, its points moved at random by `noise` [m]."""
    points = rounded(CORNERS[name])
    n = len(points)
    points = points + noise * np.random.default_rng(5).standard_normal(points.shape)
    wave = 2 * np.pi * np.arange(n) / n
    widths = np.column_stack([5 + np.sin(3 * wave), 5 + np.cos(4 * wave)])
    if backwards:
        points, widths = points[::-1], widths[::-1, ::-1]
    return PathRoad(points, widths, closed=True)


def two_hairpins(radius: float = 9.0, straight: float = 150.0) -> PathRoad:
    """Straights joined by half turns to the left and to the right; 6 m to each side."""
    spacing, arc = 5.0, np.pi * radius
    bends = [(100.0, 0.0), (arc, 1 / radius), (straight, 0.0), (arc, -1 / radius), (60.0, 0.0)]
    fine = 0.05
    kappa = np.concatenate([np.full(round(length / fine), bend) for length, bend in bends])
    line = np.concatenate([[0], np.cumsum(fine * np.exp(1j * fine * np.cumsum(kappa)))])[:: round(spacing / fine)]
    return PathRoad(np.column_stack([line.real, line.imag]), np.full((len(line), 2), 6.0))
