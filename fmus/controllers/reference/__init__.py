"""ReferenceTrajectory: plays a built-in manoeuvre or a CSV file as the trajectory bus."""

from fmukit.component import Component
from fmus.controllers.reference.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.controllers.reference.model")
