"""Radio: what one car tells another of its motion."""

from fmukit.component import Component
from fmus.sensors.radio.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.sensors.radio.model")
