"""What the controllers assume about the car: parameters `design.*`, started from the nominal vehicle."""

from __future__ import annotations

from collections.abc import Iterable

from fmukit.interface import Variable, parameter
from fmus.cars.nominal import DESIGN

_TEXTS = {
    "mass": ("kg", "total mass"),
    "sprung_mass": ("kg", "mass of the body above the suspension"),
    "roll_inertia": ("kg.m2", "roll inertia of the body"),
    "pitch_inertia": ("kg.m2", "pitch inertia of the body"),
    "yaw_inertia": ("kg.m2", "yaw inertia of the whole car"),
    "l_f": ("m", "distance of the front axle from the centre of gravity"),
    "l_r": ("m", "distance of the rear axle from the centre of gravity"),
    "track": ("m", "track width"),
    "rolling_radius": ("m", "effective rolling radius of the tyres"),
    "wheel_inertia": ("kg.m2", "spin inertia of one wheel"),
    "cornering_front": ("N/rad", "cornering stiffness of the front axle"),
    "cornering_rear": ("N/rad", "cornering stiffness of the rear axle"),
    "pneumatic_trail": ("m", "pneumatic trail of the tyres"),
    "relaxation_length": ("m", "lateral relaxation length of the tyres"),
    "drag_area": ("m2", "drag coefficient times frontal area"),
    "air_density": ("kg/m3", "density of the air"),
    "rolling.constant": ("1", "rolling resistance at rest relative to the load"),
    "rolling.linear": ("s/m", "growth of the rolling resistance with the speed"),
    "rolling.quartic": ("s4/m4", "growth of the rolling resistance with the fourth power of the speed"),
    "gravity": ("m/s2", "gravity"),
    "steer_inertia": ("kg.m2", "inertia of knuckle and wheel about the kingpin"),
    "steer_damping": ("N.m.s/rad", "damping of one steering joint"),
}


def design_parameters(names: Iterable[str]) -> list[Variable]:
    """One parameter `design.<name>` per field of the nominal vehicle, rolling.linear of the field rolling_linear.

    Unknown names raise KeyError.
    """
    return [_design_parameter(name, *_TEXTS[name]) for name in names]


def _design_parameter(name: str, unit: str, text: str) -> Variable:
    start = float(getattr(DESIGN, name.replace(".", "_")))
    return parameter(
        f"design.{name}", unit, f"assumed {text}", start, minimum=0.0, source="nominal vehicle, fmus/vehicle16dof"
    )
