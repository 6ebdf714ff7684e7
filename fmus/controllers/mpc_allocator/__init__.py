"""MpcAllocator: offset-free model predictive control and the distribution of its forces to four wheels."""

from fmukit.component import Component
from fmus.controllers.mpc_allocator.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.controllers.mpc_allocator.model")
