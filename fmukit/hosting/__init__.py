"""Running FMUs in a host that is not Python: the environment it needs, and whether this machine has all of it."""
