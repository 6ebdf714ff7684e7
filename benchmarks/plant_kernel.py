"""One RK4 step of the plant kernel, tyres included, beside MuJoCo's RK4 step of the same tree without tyres."""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import mujoco
import numpy as np

from fmukit.compiling import compiler
from fmukit.direct import Direct
from fmus.vehicle16dof import COMPONENT, INTERFACE
from fmus.vehicle16dof.states import CORNERS, Corner

STEP = 0.001
_STEPS = 20_000
ROUNDS = 7
# glibc has a function `step` of its own; `loop` must be seen
_FLAGS = ("-Wl,-Bsymbolic", "-fvisibility=default")
_LOOP = """
#include "plant.c"
#include <string.h>
void loop(const double *p, const double *d, const double *u, double *x, double h, int nx, int count) {
  static const double *arg[SZ_ARG]; static double *res[SZ_RES];
  static casadi_int iw[SZ_IW + 1]; static double w[SZ_W + 1], next[256];
  for (int i = 0; i < count; ++i) {
    arg[0] = p; arg[1] = d; arg[2] = u; arg[3] = x; arg[4] = &h; res[0] = next;
    step(arg, res, iw, w, 0);
    memcpy(x, next, nx * sizeof(double));
  }
}
"""
_DRIVING = {"steer_torque.fl": 20.0, "steer_torque.fr": 20.0, "wheel_torque.rl": 60.0, "wheel_torque.rr": 60.0}


def measure(rounds: int = ROUNDS) -> dict[str, float]:
    """Best of several rounds, both in C loops of this process: `kernel` and `mujoco` [us per step], and their ratio."""
    with tempfile.TemporaryDirectory() as folder:
        plant = _plant(Path(folder))
        tree = _tree()
        times = [(_timed(plant), _timed(tree)) for _ in range(rounds)]
    kernel, peer = (min(column) / _STEPS * 1e6 for column in zip(*times, strict=True))
    return {"kernel": kernel, "mujoco": peer, "ratio": kernel / peer}


def _timed(run: Callable[[], None]) -> float:
    start = time.perf_counter()
    run()
    return time.perf_counter() - start


def _plant(folder: Path) -> Callable[[], None]:
    """A call that makes the driving car's steps, checked against casadi's own machine."""
    car = Direct(COMPONENT, {"initial.speed": 25.0}, _DRIVING)
    _compile(car.kernel.step, folder)
    library = ctypes.CDLL(str(folder / "loop.so"))
    arrays = [np.array(a, dtype=float) for a in (car.p, car.d, car.u, car.x)]
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in arrays]

    def run(count: int = _STEPS) -> None:
        library.loop(*pointers, ctypes.c_double(STEP), len(car.x), count)

    run(1)
    car.advance(STEP)
    if not np.allclose(arrays[3], car.x, rtol=1e-12, atol=1e-12):
        raise RuntimeError("the compiled kernel and casadi disagree")
    return run


def _compile(step: ca.Function, folder: Path) -> None:
    generator = ca.CodeGenerator("plant.c")
    generator.add(step)
    generator.generate(f"{folder}/")
    (folder / "loop.c").write_text(_LOOP)
    sizes = {"ARG": step.sz_arg(), "RES": step.sz_res(), "IW": step.sz_iw(), "W": step.sz_w()}
    platform = compiler.host_platform()
    flags = [*compiler.flags(platform), *_FLAGS, *(f"-DSZ_{name}={size}" for name, size in sizes.items())]
    command = [*compiler.command(platform), *flags, "loop.c", "-o", "loop.so", "-lm"]
    subprocess.run(command, cwd=folder, check=True)


def _tree() -> Callable[[], None]:
    """A call that makes MuJoCo's steps of the tumbling tree: no contacts, constraints or springs."""
    model = mujoco.MjModel.from_xml_string(_mjcf({v.name: float(v.start) for v in INTERFACE.select("parameter")}))
    data = mujoco.MjData(model)
    data.qvel[:] = 0.1 * np.random.default_rng(0).normal(size=model.nv)
    return lambda: mujoco.mj_step(model, data, nstep=_STEPS)


def _mjcf(p: dict[str, float]) -> str:
    """The car's tree of 16 degrees of freedom; slide and kingpin share one body, which suits MuJoCo best."""
    inertia = " ".join(str(p[f"body.inertia.{a}"]) for a in "xyz")
    legs = "".join(_leg(p, corner) for corner in CORNERS)
    return f"""<mujoco>
      <option timestep="{STEP}" integrator="RK4"><flag contact="disable" constraint="disable"/></option>
      <worldbody><body><freejoint/>
      <inertial pos="{p["body.cog.x"]} 0 {p["body.cog.z"]}" mass="{p["body.mass"]}" diaginertia="{inertia}"/>
      {legs}</body></worldbody></mujoco>"""


def _leg(p: dict[str, float], corner: Corner) -> str:
    x = p["geometry.front_axle"] if corner.steered else -p["geometry.rear_axle"]
    y, z = corner.side * p[f"geometry.track_{corner.axle}"] / 2, -p[f"geometry.wheel_drop_{corner.axle}"]
    knuckle = " ".join(str(p[f"knuckle.inertia.{a}"]) for a in "xyz")
    across, spin = p["wheel.inertia.diametral"], p["wheel.inertia.spin"]
    kingpin = '<joint type="hinge" axis="0 0 1"/>' if corner.steered else ""
    return f"""<body pos="{x} {y} {z}"><joint type="slide" axis="0 0 1"/>{kingpin}
      <inertial pos="0 0 0" mass="{p["knuckle.mass"]}" diaginertia="{knuckle}"/>
      <body><joint type="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="{p["wheel.mass"]}" diaginertia="{across} {spin} {across}"/></body></body>"""
