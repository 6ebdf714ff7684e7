"""The components under test with their kernels, built once."""

import pytest

from fmus.estimator import COMPONENT as FILTER
from fmus.sensors.gps import COMPONENT as GPS
from fmus.sensors.imu import COMPONENT as IMU


@pytest.fixture(scope="session")
def imu():
    return IMU, IMU.kernel()


@pytest.fixture(scope="session")
def gps():
    return GPS, GPS.kernel()


@pytest.fixture(scope="session")
def chain(imu, gps):
    """Imu, GpsReceiver and NavigationFilter, as `navigate` takes them."""
    return imu, gps, (FILTER, FILTER.kernel())
