"""Vehicle16Dof: the multibody car of 16 degrees of freedom. Equations and frames: README.md."""

from fmukit.component import Component
from fmus.vehicle16dof.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.vehicle16dof.model")
