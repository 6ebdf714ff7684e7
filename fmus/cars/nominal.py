"""The nominal car: what is assumed of Vehicle16Dof with its start values. The only place where it is made."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import load_parameters
from fmus.cars.multibody import assumed_car

PLANT_PARAMETERS = Path(__file__).parents[1] / "vehicle16dof" / "parameters.toml"


def plant_values(path: Path = PLANT_PARAMETERS) -> dict[str, float]:
    """The parameters of Vehicle16Dof by name, from a file of them."""
    return {variable.name: float(variable.start) for variable in load_parameters(path)}


DESIGN = assumed_car(plant_values())
"""The nominal car, computed once."""
