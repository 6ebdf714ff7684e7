"""What can go wrong while planning and is the user's to put right."""

from __future__ import annotations


class PlanningError(Exception):
    """There is no plan; the message is one sentence saying why, and what to change."""
