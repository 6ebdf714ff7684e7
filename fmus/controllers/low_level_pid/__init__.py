"""LowLevelPid: speed, yaw rate, steering and active suspension from selectable error differential equations."""

from fmukit.component import Component
from fmus.controllers.low_level_pid.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.controllers.low_level_pid.model")
