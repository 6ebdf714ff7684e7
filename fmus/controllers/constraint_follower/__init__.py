"""ConstraintFollower: keeps its place in a formation by the forces that constraints between vehicles would exert."""

from fmukit.component import Component
from fmus.controllers.constraint_follower.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.controllers.constraint_follower.model")
