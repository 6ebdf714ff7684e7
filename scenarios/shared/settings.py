"""Settings that several families offer. Light to import: `cosim list` shows them."""

from cosim.scenario.settings import Setting

SENSORS = {
    "feedback": Setting("filter", ("filter", "truth"), "what the controllers see: the filter's estimate or the truth"),
    "gps_profile": Setting("rtk", ("rtk", "dgps", "standalone", "phone"), "kind of satellite receiver"),
    "imu_profile": Setting("automotive", ("automotive", "tactical", "mems"), "grade of the inertial unit"),
}
"""Those of the sensors of a car, and of who sees what."""
