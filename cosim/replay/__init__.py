"""Measured data in: a log of real sensors feeds an FMU or a system, and what comes out is held against the log."""
