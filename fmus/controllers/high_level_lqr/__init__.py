"""HighLevelLqr: finite-horizon linear quadratic tracking with feed-forward by stable inversion."""

from fmukit.component import Component
from fmus.controllers.high_level_lqr.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.controllers.high_level_lqr.model")
