"""What can go wrong while planning and is the user's to put right."""

from __future__ import annotations


class PlanningError(Exception):
    """There is no plan; the message is one sentence saying why, and what to change."""


class SearchError(PlanningError):
    """The solver ended without a plan: its `status`, its `iterations` and the `interval` with the largest gap."""

    def __init__(self, status: str, iterations: int, interval: int) -> None:
        super().__init__(f"the search ended without a plan (IPOPT: {status} after {iterations} iterations)")
        self.status, self.iterations, self.interval = status, iterations, interval
