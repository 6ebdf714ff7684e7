"""The double-track car that stands for Vehicle16Dof: every number follows from that car's parameters.toml."""

from __future__ import annotations

from dataclasses import replace

from fmus.design import DESIGN, DesignModel
from fmus.double_track.interface import INTERFACE
from fmus.single_track.data import Tyre
from fmus.single_track.design import design_car


def from_design(design: DesignModel = DESIGN) -> dict[str, float]:
    """Parameters of DoubleTrack by name for a design model.

    The tyre forces of that car act the pneumatic trail t behind the axles, so its axles carry m a_y (l_R + t)/L and
    m a_y (l_F - t)/L; here they carry m a_y l_R/L and m a_y l_F/L, and the slip stiffnesses are scaled for the same
    slip angles. Of the drag only c_w A is known: the frontal area keeps its start value, the coefficient makes the
    product.
    """
    car, t = design_car(design), design.pneumatic_trail
    front = replace(car.front, B=car.front.B * car.l_R / (car.l_R + t))
    rear = replace(car.rear, B=car.rear.B * car.l_F / (car.l_F - t))
    area = next(float(v.start) for v in INTERFACE.select("parameter") if v.name == "body.frontal_area")
    return {
        "gravity": car.g,
        "air.density": design.air_density,
        "body.mass": car.m,
        "body.inertia.z": car.I_zz,
        "body.drag_coefficient": design.drag_area / area,
        "body.frontal_area": area,
        "geometry.front_axle": car.l_F,
        "geometry.rear_axle": car.l_R,
        "geometry.half_track": 0.5 * design.track,
        "geometry.cog_height": design.cog_height,
        "wheel.radius": car.R,
        **_tyre("front", front),
        **_tyre("rear", rear),
        **dict(zip(("rolling.constant", "rolling.linear", "rolling.quartic"), car.rolling, strict=True)),
    }


def _tyre(axle: str, tyre: Tyre) -> dict[str, float]:
    return {
        f"tyre.{axle}.stiffness_factor": tyre.B,
        f"tyre.{axle}.shape_factor": tyre.C,
        f"tyre.{axle}.peak": tyre.D,
        f"tyre.{axle}.curvature_factor": tyre.E,
    }
