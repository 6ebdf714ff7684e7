"""Reference states, inputs and forces along a plan, and the four wheel forces that come closest to its motion.

y* = (F_x, F_y, M_z) is what moves the planned single-track car; the double-track car in the same state, with the wheel
loads of the planned accelerations, realises it as well as the limits of its wheels allow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import casadi as ca
import numpy as np
import osqp
from scipy import sparse

from fmus.cars.double_track import DoubleTrackCar
from fmus.cars.single_track import SingleTrackCar
from fmus.cars.wheels import WHEELS
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.double_track import distribution
from fmus.double_track.distribution import Limits, Weights
from fmus.double_track.model import motion
from fmus.planner import check
from fmus.planner.errors import PlanningError
from fmus.planner.files import write_table
from fmus.planner.gates import Array
from fmus.planner.hocp import Plan
from fmus.single_track.forces import STATES

_Y = ("force_x", "force_y", "moment_z")
COLUMNS = (
    "time",
    *STATES,
    "omega_delta",
    "axle_force.front",
    "axle_force.rear",
    *(f"wanted.{name}" for name in _Y),
    *(f"wheel_force.{wheel}" for wheel in WHEELS),
    *(f"residual.{name}" for name in _Y),
)
_TOLERANCE = 1e-8


@dataclass(frozen=True, slots=True)
class Forces:
    """Along a plan at n times [s]: `states` (7, n), `wanted` y* (3, n) [N, N, N.m], wheel forces `U` (4, n) [N].

    `inputs` (3, n): steering rate and axle forces. `residual` (3, n) [N, N, N.m]: what the wheel forces give too much.
    """

    times: Array
    states: Array
    inputs: Array
    wanted: Array
    U: Array
    residual: Array

    @property
    def rms(self) -> Array:
        """(3,) root mean square of the residual."""
        return np.asarray(np.sqrt(np.mean(self.residual**2, axis=1)))

    @property
    def largest(self) -> Array:
        """(3,) largest magnitude of the residual."""
        return np.asarray(np.max(np.abs(self.residual), axis=1))


def along(
    plan: Plan,
    car: DoubleTrackCar,
    *,
    limits: Limits | None = None,
    weights: Weights | None = None,
    available: Sequence[float] = (1.0, 1.0, 1.0, 1.0),
    finer: int = check.FINER,
) -> Forces:
    """Wheel forces along a plan of the single-track car `car.planar`; `available`: 1 sound motor, 0 lost, per wheel.

    Limits and weights are the start values of MpcAllocator unless given, but for the friction of the plan. Each time
    is solved by itself, without a rate limit and a weight of the change: planned inputs jump. With the friction ellipse
    lateral forces are for the QP those left beside the planned forces, for the residual those left beside the forces
    found. Raises PlanningError for a plan of a car whose axle forces are not known.
    """
    vehicle = plan.vehicle
    if vehicle.axle_forces is None:
        raise PlanningError(f"the forces of the axles are not known of the car {vehicle.name}; plan with another")
    times, x, u = check.fine(vehicle, plan.nodes, plan.substeps, finer)
    axles, y = vehicle.axle_forces(u).full(), _wanted(car.planar, vehicle.f)(x, u).full()
    limits, weights = limits or default_limits(vehicle.friction), weights or default_weights()
    data, lack = _problem(car, vehicle.friction, limits, weights, available)
    U = _solved(*(part.full() for part in data(x, axles, y)))
    return Forces(times, x, np.vstack([u[:1], axles]), y, U, lack(x, y, U).full())


def default_limits(friction: float | None = None) -> Limits:
    """Those of MpcAllocator with its start values, with another friction if given."""
    found = distribution.limits_of(_starts())
    return found if friction is None else replace(found, friction=friction)


def default_weights() -> Weights:
    """Those of MpcAllocator with its start values; each time by itself has no change to weigh."""
    return replace(distribution.weights_of(_starts()), rho=0.0)


def write(forces: Forces, file: Path) -> None:
    """Write `COLUMNS` as CSV; raises PlanningError when the file cannot be written."""
    f = forces
    write_table(COLUMNS, np.vstack([f.times, f.states, f.inputs, f.wanted, f.U, f.residual]).T, file)


def _starts() -> dict[str, float | bool | str]:
    return {variable.name: variable.start for variable in INTERFACE.select("parameter")}


def _wanted(car: SingleTrackCar, f: ca.Function) -> ca.Function:
    """(x, u) -> y* (3): the body forces and the moment behind x' of the planned car, planar motion inverted."""
    x, u = ca.SX.sym("x", f.size1_in(0)), ca.SX.sym("u", f.size1_in(1))
    rate = f(x, u)
    along, across = car.m * rate[2], car.m * x[2] * (rate[3] + x[5])
    c, s = ca.cos(x[3]), ca.sin(x[3])
    y = ca.vertcat(along * c - across * s, along * s + across * c, car.I_zz * rate[5])
    return ca.Function("wanted", [x, u], [y])


def _problem(
    car: DoubleTrackCar, friction: float | None, limits: Limits, weights: Weights, available: Sequence[float]
) -> tuple[ca.Function, ca.Function]:
    """(x, axle forces, y*) -> P_nz, q, l, u of the QP; (x, y*, U) -> residual of the forces U."""
    x, axles, y, U = (ca.SX.sym(name, n) for name, n in (("x", len(STATES)), ("axles", 2), ("y", 3), ("U", 4)))
    a, planned = y[:2] / car.planar.m, ca.vertcat(axles[0], axles[0], axles[1], axles[1]) / 2
    G, (_, F_z, F_t) = distribution.effectiveness(car, x[6]), distribution.without_drive(car, x, a)
    c = _given(car, friction, x, planned, a) - G @ planned
    low, high = distribution.bounds(limits, F_z, F_t, x[2], available=ca.DM(list(available)))
    P_nz, q, _, least, most = distribution.problem(
        G, c, y, previous=ca.DM.zeros(4), low=low, high=high, weights=weights
    )
    return (
        ca.Function("distribution", [x, axles, y], [P_nz, q, least, most]),
        ca.Function("residual", [x, y, U], [_given(car, friction, x, U, a) - y]),
    )


def _given(car: DoubleTrackCar, friction: float | None, x: ca.SX, U: ca.SX, a: ca.SX) -> ca.SX:
    """y (3) of the double-track car under the wheel forces U."""
    found = motion(car, x, ca.vertcat(0, U), a, friction)
    return ca.vertcat(car.planar.m * found.acceleration, car.planar.I_zz * found.x_dot[5])


def _solved(P_nz: Array, q: Array, low: Array, high: Array) -> Array:
    """U (4, n) [N] of n problems, one column each; OSQP warm started along the plan."""
    rows, columns = distribution.PATTERN_P.get_triplet()
    first = sparse.csc_matrix((P_nz[:, 0], (rows, columns)), shape=(4, 4))
    options = {"eps_abs": _TOLERANCE, "eps_rel": _TOLERANCE, "max_iter": 20000, "scaling": 0, "verbose": False}
    solver, U = osqp.OSQP(), np.zeros((4, q.shape[1]))
    P_nz, q, low, high = (np.asfortranarray(part) for part in (P_nz, q, low, high))
    solver.setup(first, q[:, 0], sparse.eye(4, format="csc"), low[:, 0], high[:, 0], **options)
    for k in range(q.shape[1]):
        solver.update(Px=P_nz[:, k], q=q[:, k], l=low[:, k], u=high[:, k])
        found = solver.solve(raise_error=False)
        if found.info.status_val != osqp.SolverStatus.OSQP_SOLVED:
            raise PlanningError(f"the wheel forces at point {k} of the plan were not found (OSQP: {found.info.status})")
        U[:, k] = distribution.N * np.clip(found.x, low[:, k], high[:, k])
    return U
