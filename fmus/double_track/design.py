"""The double-track car that stands for Vehicle16Dof: every number follows from that car's parameters.toml."""

from __future__ import annotations

from fmus.cars.nominal import DESIGN, DesignModel
from fmus.double_track import data
from fmus.double_track.data import DoubleTrackCar
from fmus.double_track.interface import INTERFACE
from fmus.single_track.data import Tyre
from fmus.single_track.design import design_car


def from_design(design: DesignModel = DESIGN) -> dict[str, float]:
    """Parameters of DoubleTrack by name for a design model; its axles are those of the single-track car `design_car`.

    Of the drag only c_w A is known: the frontal area keeps its start value, the coefficient makes the product.
    """
    car = design_car(design)
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
        **_tyre("front", car.front),
        **_tyre("rear", car.rear),
        **dict(zip(("rolling.constant", "rolling.linear", "rolling.quartic"), car.rolling, strict=True)),
    }


def _tyre(axle: str, tyre: Tyre) -> dict[str, float]:
    return {
        f"tyre.{axle}.stiffness_factor": tyre.B,
        f"tyre.{axle}.shape_factor": tyre.C,
        f"tyre.{axle}.peak": tyre.D,
        f"tyre.{axle}.curvature_factor": tyre.E,
    }


def double_track_car(design: DesignModel = DESIGN) -> DoubleTrackCar:
    """The same car for the equations of `model`."""
    start = {variable.name: variable.start for variable in INTERFACE.select("parameter")}
    return data.of(start | from_design(design), design_car(design))
