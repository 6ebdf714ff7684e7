"""A car that follows a trajectory by the controllers of chapter 4."""
