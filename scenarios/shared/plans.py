"""Trajectories planned for scenarios: made at the first use, then kept in the user's store.

A file is found by everything that went into it: road, car and its limits, ends, mesh, and the sources of the planner.
Derivatives are always evaluated in one way, by CasADi's virtual machine, so that the same plan has the same digits
whether or not a compiler is installed.
"""

from __future__ import annotations

import logging
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from hashlib import blake2b
from importlib.metadata import version
from pathlib import Path

import numpy as np

import fmus
from cosim.errors import CosimError
from fmukit import store
from fmukit.errors import BuildError, because
from fmus.planner import hocp, trajectory
from fmus.planner.adaptive import planning
from fmus.planner.errors import PlanningError
from fmus.planner.hocp import Plan, Road
from fmus.planner.path_road import PathRoad
from fmus.planner.program import Ends
from fmus.planner.vehicle import Vehicle

_KINDS = {".py", ".toml"}
_SETTINGS = hocp.PlanSettings(grid="gate", compile=False)
_LOG = logging.getLogger("cosim")


def planned(name: str, vehicle: Vehicle, road: Road, m: int, ends: Ends | None = None) -> Path:
    """The trajectory file of the time-optimal motion on m intervals of the gate grid, planned if it is not there yet.

    `name` begins the file's name. Raises CosimError when there is no such motion or it cannot be kept.
    """
    with _told(name):
        parts = [*_of_vehicle(vehicle), *_of_road(road, m), *_of_ends(ends), repr(_SETTINGS)]
        return _made(name, parts, lambda: hocp.plan(vehicle, road, m, ends, _SETTINGS))


def planned_along(name: str, vehicle: Vehicle, road: PathRoad, ends: Ends) -> Path:
    """The same on a mesh that follows the road."""
    numbers = (road.points, road.widths, np.array([road.clearance, road.closed]))
    parts = [*_of_vehicle(vehicle), *(array.tobytes() for array in numbers), *_of_ends(ends), repr(_SETTINGS)]
    with _told(name):
        return _made(name, parts, lambda: planning.plan(vehicle, road, ends, _SETTINGS))


@contextmanager
def _told(name: str) -> Iterator[None]:
    """Why there is no plan is a sentence for the user."""
    try:
        yield
    except PlanningError as error:
        raise CosimError(f"{name} cannot be planned: {error}") from error


def _made(name: str, parts: list[str | bytes], plan: Callable[[], Plan]) -> Path:
    def make(file: Path) -> None:
        found = plan()
        _LOG.info("planned %s: %.3f s, %d iterations, %s", name, found.final_time, found.iterations, _worth(found))
        trajectory.write(found, file)

    return kept(name, parts, make)


def kept(name: str, parts: Iterable[str | bytes], make: Callable[[Path], None], doing: str = "planning") -> Path:
    """The cached file made by `make(file)` from what `parts` say, made now if it is not there or damaged.

    `parts` must hold all that differs from call to call; the sources of the components are part of the key anyway.
    `doing` is what the log says of making it. Files not used for a month are removed. Raises CosimError when the file
    cannot be kept.
    """

    def made() -> bytes:
        _LOG.info("%s %s, which later runs find in %s", doing, name, store.cache_folder())
        with tempfile.TemporaryDirectory(prefix="cosim-") as folder:
            file = Path(folder) / f"{name}.csv"
            make(file)
            return file.read_bytes()

    try:
        return store.kept(f"trajectory-{_key(parts)}", f"{name}.csv", made)
    except BuildError as error:
        raise CosimError(f"cannot keep the plan of {name}: {error}") from None
    except OSError as error:
        remedy = "make room there, or set TMPDIR to a folder you can write into"
        raise CosimError(f"cannot write the plan of {name}: {because(error)}; {remedy}") from None


def _key(parts: Iterable[str | bytes]) -> str:
    digest = blake2b(digest_size=8)
    for part in (_sources(), *parts):
        data = part.encode() if isinstance(part, str) else part
        digest.update(f"{len(data)}\n".encode() + data)
    return digest.hexdigest()


def _sources() -> str:
    """Hash of the sources of all components, and the version of CasADi, whose solver finds the plan."""
    digest = blake2b(version("casadi").encode(), digest_size=16)
    root = Path(fmus.__file__).parent
    for path in sorted(path for path in root.rglob("*") if path.suffix in _KINDS):
        data = path.read_bytes()
        digest.update(f"{path.relative_to(root).as_posix()} {len(data)}\n".encode() + data)
    return digest.hexdigest()


def _of_vehicle(vehicle: Vehicle) -> list[str | bytes]:
    numbers = (vehicle.lower, vehicle.upper, vehicle.scale)
    inputs = (vehicle.input_lower, vehicle.input_upper, vehicle.input_scale, vehicle.idle)
    own = "" if vehicle.limits is None else vehicle.limits.serialize()
    return [vehicle.f.serialize(), own, *(array.tobytes() for array in (*numbers, *inputs))]


def _of_road(road: Road, m: int) -> list[str | bytes]:
    gates = road.gates(m)
    return [gates.frames.tobytes(), gates.low.tobytes(), gates.high.tobytes(), repr(gates.closed)]


def _of_ends(ends: Ends | None) -> list[str | bytes]:
    return ["standing"] if ends is None else [ends.first.tobytes(), ends.last.tobytes()]


def _worth(plan: Plan) -> str:
    return f"leaves the road by at most {1e3 * plan.violation:.0f} mm between its nodes"
