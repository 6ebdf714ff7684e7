"""GpsReceiver: satellite positioning with two antennas."""

from fmukit.component import Component
from fmus.sensors.gps.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.sensors.gps.model")
