"""NavigationFilter: two-stage Kalman filter for attitude, heading, position and velocity."""

from fmukit.component import Component
from fmus.estimator.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.estimator.model")
