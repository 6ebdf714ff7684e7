"""AdaptiveFollower: keeps its place in a formation; a neural network learns the unknown velocity of the leader."""

from fmukit.component import Component
from fmus.controllers.adaptive_follower.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.controllers.adaptive_follower.model")
