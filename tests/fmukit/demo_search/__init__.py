"""A sampled component that solves a small NLP with IPOPT: for tests of fmukit only. Its `__init__` does not travel."""

from __future__ import annotations

from fmukit.component import Component
from fmukit.interface import CsvTable, input_, output, parameter, sampled

INTERFACE = sampled(
    "DemoSearch",
    "The nearest point of a hyperbola, searched for by IPOPT",
    step=1e-2,
    table=CsvTable("level_file", ("time", "level"), 5),
    variables=[
        parameter("product", "1", "product of the coordinates of a point of the hyperbola", 2.0, minimum=0.1),
        parameter("mirrored", "1", "whether the y coordinate is put out with the other sign", False),
        parameter("level_file", "1", "CSV file of levels to add to the target; empty for none", ""),
        input_("target.x", "m", "point to be near to", 3.0, minimum=-1e3, maximum=1e3),
        input_("target.y", "m", "point to be near to", 1.0, minimum=-1e3, maximum=1e3),
        output("nearest.x", "m", "nearest point of the hyperbola"),
        output("nearest.y", "m", "nearest point of the hyperbola"),
        output("level", "m", "level at the sampling instant"),
        output("count", "1", "number of samples so far"),
    ],
)
COMPONENT = Component(INTERFACE, "demo_search.model", ("casadi",))
