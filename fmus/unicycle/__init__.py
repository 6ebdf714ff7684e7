"""Unicycle: the kinematic vehicle. Equations in README.md."""

from fmukit.component import Component
from fmus.unicycle.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.unicycle.model")
