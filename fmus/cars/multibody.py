"""From the parameters of Vehicle16Dof to the car that controllers, filter and planner assume."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from fmus.cars.assumed import AssumedCar
from fmus.vehicle16dof import magic

SECANT_ACCELERATION = 4.0
"""Lateral acceleration [m/s2] at which the axle cornering stiffness is taken (engineering choice)."""

Values = Mapping[str, float]


def assumed_car(v: Values) -> AssumedCar:
    """The car whose parameters by name are `v`, SI units.

    Inertias are about the total centre of gravity; the pneumatic trail is the mean over both axles at static load.
    """
    loads, inertia = _static_loads(v), _inertia(v)
    sinking = sum(loads) / 2.0 / v["tyre.vertical_stiffness"]
    rough = AssumedCar(
        mass=_mass(v),
        sprung_mass=v["body.mass"],
        roll_inertia=inertia[0],
        pitch_inertia=inertia[1],
        yaw_inertia=inertia[2],
        l_f=v["geometry.front_axle"],
        l_r=v["geometry.rear_axle"],
        track=0.5 * (v["geometry.track_front"] + v["geometry.track_rear"]),
        cog_height=_height(v, loads),
        wheel_radius=v["wheel.radius"],
        rolling_radius=v["wheel.radius"] - sinking / 3.0,
        wheel_inertia=v["wheel.inertia.spin"],
        spring_front=v["suspension.front.stiffness"],
        spring_rear=v["suspension.rear.stiffness"],
        anti_roll_front=v["suspension.front.anti_roll"],
        anti_roll_rear=v["suspension.rear.anti_roll"],
        tyre_stiffness=v["tyre.vertical_stiffness"],
        cornering_front=0.0,
        cornering_rear=0.0,
        pneumatic_trail=v["tyre.trail"] * sum(loads) / 2.0 / v["tyre.nominal_load"],
        relaxation_length=v["tyre.relaxation.lateral"],
        drag_area=v["body.drag_coefficient"] * v["body.frontal_area"],
        air_density=v["air.density"],
        rolling_constant=v["tyre.rolling.constant"],
        rolling_linear=v["tyre.rolling.linear"],
        rolling_quartic=v["tyre.rolling.quartic"],
        gravity=v["gravity"],
        steer_inertia=v["knuckle.inertia.z"] + v["wheel.inertia.diametral"],
        steer_damping=v["steering.damping"],
        tyre={name.removeprefix("tyre."): value for name, value in v.items() if name.startswith("tyre.")},
    )
    front, rear = _cornering(rough, loads)
    return replace(rough, cornering_front=front, cornering_rear=rear)


def _mass(v: Values) -> float:
    return v["body.mass"] + 4.0 * (v["knuckle.mass"] + v["wheel.mass"])


def _static_loads(v: Values) -> tuple[float, float]:
    """Load [N] of one front and one rear wheel."""
    l_F, l_R = v["geometry.front_axle"], v["geometry.rear_axle"]
    half = 0.5 * _mass(v) * v["gravity"] / (l_F + l_R)
    return half * l_R, half * l_F


def _height(v: Values, loads: tuple[float, float]) -> float:
    """Height of O1 above the ground [m] with the suspension at zero travel."""
    l_F, l_R = v["geometry.front_axle"], v["geometry.rear_axle"]
    front, rear = (
        v["wheel.radius"] - load / v["tyre.vertical_stiffness"] + v[f"geometry.wheel_drop_{axle}"]
        for load, axle in zip(loads, ("front", "rear"), strict=True)
    )
    return (l_R * front + l_F * rear) / (l_F + l_R)


def _inertia(v: Values) -> tuple[float, float, float]:
    """Principal inertias [kg.m2] of the whole car about O1, steering straight."""
    x, y, z, m = v["body.cog.x"], v["body.cog.y"], v["body.cog.z"], v["body.mass"]
    I_x = v["body.inertia.x"] + m * (y * y + z * z)
    I_y = v["body.inertia.y"] + m * (x * x + z * z)
    I_z = v["body.inertia.z"] + m * (x * x + y * y)
    m_u = v["knuckle.mass"] + v["wheel.mass"]
    for axle in ("front", "rear"):
        x, y = v[f"geometry.{axle}_axle"], 0.5 * v[f"geometry.track_{axle}"]
        drop = v[f"geometry.wheel_drop_{axle}"]
        I_x += 2.0 * (m_u * (y * y + drop * drop) + v["knuckle.inertia.x"] + v["wheel.inertia.diametral"])
        I_y += 2.0 * (m_u * (x * x + drop * drop) + v["knuckle.inertia.y"] + v["wheel.inertia.spin"])
        I_z += 2.0 * (m_u * (x * x + y * y) + v["knuckle.inertia.z"] + v["wheel.inertia.diametral"])
    return I_x, I_y, I_z


def _cornering(car: AssumedCar, loads: tuple[float, float]) -> tuple[float, float]:
    """Axle cornering stiffness [N/rad]: secant force over slip angle in a steady turn at SECANT_ACCELERATION.

    The axles carry F_F = m a_y (l_R + t)/L and F_R = m a_y (l_F - t)/L; the load transfer m a_y h/d, magnified by the
    overturning of the rolled body, is split by the roll stiffnesses.
    """
    force, stiffness = car.mass * SECANT_ACCELERATION, sum(car.roll_stiffness)
    overturning = stiffness / (stiffness - car.mass * car.gravity * car.cog_height)
    arms = car.l_r + car.pneumatic_trail, car.l_f - car.pneumatic_trail
    front, rear = (
        _secant(
            car.tyre,
            load,
            force * car.cog_height * overturning * roll / stiffness / car.track,
            force * arm / car.wheelbase,
        )
        for load, roll, arm in zip(loads, car.roll_stiffness, arms, strict=True)
    )
    return front, rear


def _secant(k: Values, load: float, transfer: float, force: float) -> float:
    """Bisection for the slip angle [rad] at which both wheels of an axle give `force` [N]; returns force / slip."""
    low, high = 0.0, 0.3
    for _ in range(60):
        alpha = 0.5 * (low + high)
        given = -sum(magic.lateral(math, k, F_z, 1.0, math.tan(alpha)) for F_z in (load - transfer, load + transfer))
        low, high = (alpha, high) if given < force else (low, alpha)
    return force / low
