"""What an FMU shows: its variables, its kind and its step. No mathematics, no FMI calls, no casadi.

Every component declares one `Interface`. The order of its variables is the order of the slots in the instance's
buffer, and the FMI value reference of a variable is its slot: parameters first, then inputs, then outputs.
"""

from fmukit.interface.declaration import Advice, CsvTable, Interface, Kind, continuous, sampled
from fmukit.interface.toml import load_parameters
from fmukit.interface.variable import AXES, Causality, Type, Value, Variable, group, input_, output, parameter

__all__ = [
    "AXES",
    "Advice",
    "Causality",
    "CsvTable",
    "Interface",
    "Kind",
    "Type",
    "Value",
    "Variable",
    "continuous",
    "group",
    "input_",
    "load_parameters",
    "output",
    "parameter",
    "sampled",
]
