"""The names of the wheels, in the order of every vector over them."""

WHEELS = ("fl", "fr", "rl", "rr")
FRONT = WHEELS[:2]
