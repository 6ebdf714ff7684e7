"""What moves, with its first two derivatives."""

from __future__ import annotations

from typing import Any, NamedTuple


class MovingPlace(NamedTuple):
    """A place with its first and second derivative, such as (x, y, psi) of O1 in the world (3 each)."""

    place: Any
    rate: Any
    acceleration: Any
