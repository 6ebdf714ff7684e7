"""The planar cars that stand for an assumed car: from it the single-track car, from that the double-track car."""

from __future__ import annotations

from fmus.cars import published
from fmus.cars.assumed import AssumedCar
from fmus.cars.axle_fit import axle_tyres
from fmus.cars.double_track import DoubleTrackCar
from fmus.cars.single_track import SingleTrackCar, Tyre


def single_track(car: AssumedCar) -> SingleTrackCar:
    """Masses and lengths of the car; each axle is fitted to two of its tyres in a steady turn.

    Plan with it by `fmus.planner.planned_cars.multibody`.
    """
    front, rear = axle_tyres(car)
    return SingleTrackCar(
        m=car.mass,
        I_zz=car.yaw_inertia,
        l_F=car.l_f,
        l_R=car.l_r,
        R=car.rolling_radius,
        g=car.gravity,
        drag=0.5 * car.drag_area * car.air_density,
        front=front,
        rear=rear,
        rolling=(car.rolling_constant, car.rolling_linear, car.rolling_quartic),
    )


def double_track(car: AssumedCar) -> DoubleTrackCar:
    """The single-track car with the track and the height of the assumed car, the least load of the published one."""
    least_load = published.double_track().least_load
    return DoubleTrackCar(single_track(car), d=0.5 * car.track, h=car.cog_height, least_load=least_load)


def double_track_values(car: AssumedCar) -> dict[str, float]:
    """Parameters of DoubleTrack by name: those of `double_track(car)`, but for the least load.

    Of the drag only c_w A is known: the frontal area is that of the published car, the coefficient makes the product.
    """
    whole = double_track(car)
    planar = whole.planar
    area = next(float(v.start) for v in published.single_track_parameters() if v.name == "body.frontal_area")
    return {
        "gravity": planar.g,
        "air.density": car.air_density,
        "body.mass": planar.m,
        "body.inertia.z": planar.I_zz,
        "body.drag_coefficient": car.drag_area / area,
        "body.frontal_area": area,
        "geometry.front_axle": planar.l_F,
        "geometry.rear_axle": planar.l_R,
        "geometry.half_track": whole.d,
        "geometry.cog_height": whole.h,
        "wheel.radius": planar.R,
        **_tyre("front", planar.front),
        **_tyre("rear", planar.rear),
        **dict(zip(("rolling.constant", "rolling.linear", "rolling.quartic"), planar.rolling, strict=True)),
    }


def _tyre(axle: str, tyre: Tyre) -> dict[str, float]:
    return {
        f"tyre.{axle}.stiffness_factor": tyre.B,
        f"tyre.{axle}.shape_factor": tyre.C,
        f"tyre.{axle}.peak": tyre.D,
        f"tyre.{axle}.curvature_factor": tyre.E,
    }
