"""How to run a system of FMI 2.0 co-simulation FMUs: clock, wiring, schedule, multirate master, recorder.

Conventions: time is integer nanoseconds inside, seconds outside; a signal is named `instance.variable`; units are those
of the FMUs' own UnitDefinitions, converted on connections where they differ by factor and offset.
"""
