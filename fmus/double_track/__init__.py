"""DoubleTrack: the planar four-wheel-driven double-track car. Equations in README.md."""

from fmukit.component import Component
from fmus.double_track.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.double_track.plant")
