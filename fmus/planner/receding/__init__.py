"""RecedingHorizonPlanner: local time-optimal problems along any road, joined while driving."""

from fmukit.component import Component
from fmus.planner.receding.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.planner.receding.model", ("casadi", "numpy"))
