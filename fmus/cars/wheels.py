"""The names of the wheels, in the order of every vector over them, and the input that says which motors work."""

from fmukit.interface import Variable, group, input_

WHEELS = ("fl", "fr", "rl", "rr")
FRONT = WHEELS[:2]


def motor_available(description: str) -> list[Variable]:
    """The inputs `motor_available.*`, 1 unless told otherwise."""
    return group(input_, "motor_available", WHEELS, "1", description, start=1.0, minimum=0.0, maximum=1.0)
