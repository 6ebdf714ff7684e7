"""The components under test with their kernels, built once and compiled: they run for hours of simulated time."""

from dataclasses import replace

import casadi as ca
import pytest

from fmukit.compiling.compiler import host_platform
from fmukit.compiling.functions import library
from fmus.estimator import COMPONENT as FILTER
from fmus.sensors.gps import COMPONENT as GPS
from fmus.sensors.imu import COMPONENT as IMU


def compiled(component):
    """The component and its kernel, whose step is C code."""
    kernel = component.kernel()
    built = library([kernel.step], component.interface.name, host_platform())
    return component, replace(kernel, step=ca.external("step", str(built)))


@pytest.fixture(scope="session")
def imu():
    return compiled(IMU)


@pytest.fixture(scope="session")
def gps():
    return compiled(GPS)


@pytest.fixture(scope="session")
def chain(imu, gps):
    """Imu, GpsReceiver and NavigationFilter, as `navigate` takes them."""
    return imu, gps, compiled(FILTER)
