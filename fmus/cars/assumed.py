"""A car as controllers, filter and planner assume it: a few numbers that stand for the whole vehicle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class AssumedCar:
    """SI units. `cornering_*` per axle [N/rad], suspension and tyre rates per corner.

    `tyre`: the factors of one tyre by their names in `vehicle16dof/parameters.toml`, without `tyre.` before them.
    """

    mass: float
    sprung_mass: float
    roll_inertia: float
    pitch_inertia: float
    yaw_inertia: float
    l_f: float
    l_r: float
    track: float
    cog_height: float
    wheel_radius: float
    rolling_radius: float
    wheel_inertia: float
    spring_front: float
    spring_rear: float
    anti_roll_front: float
    anti_roll_rear: float
    tyre_stiffness: float
    cornering_front: float
    cornering_rear: float
    pneumatic_trail: float
    relaxation_length: float
    drag_area: float
    air_density: float
    rolling_constant: float
    rolling_linear: float
    rolling_quartic: float
    gravity: float
    steer_inertia: float
    steer_damping: float
    tyre: Mapping[str, float]

    @property
    def wheelbase(self) -> float:
        """Distance of the axles [m]."""
        return self.l_f + self.l_r

    @property
    def suspension_roll_stiffness(self) -> tuple[float, float]:
        """Roll stiffness [N.m/rad] of the front and rear suspension: (k/2 + k_arb) d^2."""
        d2 = self.track**2
        return (
            (0.5 * self.spring_front + self.anti_roll_front) * d2,
            (0.5 * self.spring_rear + self.anti_roll_rear) * d2,
        )

    @property
    def roll_stiffness(self) -> tuple[float, float]:
        """Roll stiffness [N.m/rad] of front and rear, suspension in series with the tyres c_z d^2 / 2."""
        tyre = 0.5 * self.tyre_stiffness * self.track**2
        front, rear = (1.0 / (1.0 / k + 1.0 / tyre) for k in self.suspension_roll_stiffness)
        return front, rear
