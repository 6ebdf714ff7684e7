"""What the compiled problem and the code around it agree on: sizes and the order of numbers."""

from __future__ import annotations

HORIZON = 8
"""N, the intervals of one local problem on the built-in road; the problem is compiled for it."""
LONG = 24
"""N on any other road, whose fast bends need about 3 s."""

SUBSTEPS = 4
"""Steps of the integrator per interval."""
STATES, INPUTS = 7, 3
SCALE = (10.0, 1.0, 10.0, 0.1, 0.1, 0.3, 0.1)
INPUT_SCALE = (0.5, 5e3, 5e3)
"""Size of the states (x, y, v, beta, psi, omega_z, delta) and of the inputs (omega_delta, U_F, U_R)."""

CAR = (
    *("gravity", "air.density"),
    *("body.mass", "body.inertia.z", "body.drag_coefficient", "body.frontal_area"),
    *("geometry.front_axle", "geometry.rear_axle"),
    *(f"tyre.front.{name}" for name in ("stiffness_factor", "shape_factor", "peak", "curvature_factor")),
    *(f"tyre.rear.{name}" for name in ("stiffness_factor", "shape_factor", "peak", "curvature_factor")),
    *("rolling.constant", "rolling.linear", "rolling.quartic"),
)
"""Parameters of the single-track car, in the order of the constants; the friction of combined slip comes last."""
CONSTANTS = len(CAR) + 1
NO_COMBINED_SLIP = 1e9
"""A friction at which longitudinal force costs no lateral force."""

WEIGHTS = ("smoothing", "slack")

AHEAD = 61
"""Samples of the trajectory bus: now and the preview."""
PERIOD = 0.05
"""Distance of two samples of the preview [s]."""
