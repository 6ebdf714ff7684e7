"""Imu: accelerometer and gyroscope."""

from fmukit.component import Component
from fmus.sensors.imu.interface import INTERFACE

COMPONENT = Component(INTERFACE, "fmus.sensors.imu.model")
