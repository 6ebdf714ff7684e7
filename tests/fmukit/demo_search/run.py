"""What runs inside the FMU. Targets of x = 71 ... 77 stand for everything that can go wrong."""

from __future__ import annotations

import math

import casadi as ca

from .helpers.levels import level, packed

OPTIONS = {"calc_lam_p": False, "print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}


def prepare(libraries):
    return ca.nlpsol("nearest", "ipopt", libraries["hyperbola"], OPTIONS)


def initialise(tools, p, u, table):
    if u["target.x"] == 70.0:
        raise ValueError("the target lies at 70; put it elsewhere")
    d = packed(table)
    return d, [1.0, 1.0, 0.0], _outputs(p, [1.0, 1.0], level(d, 0.0), 0)


def sample(tools, p, d, u, x, t):
    target = u["target.x"]
    if target == 71.0:
        raise ValueError("the target lies at 71;\nput it 100%s elsewhere")
    if target == 72.0:
        raise SystemExit(1)
    if target == 73.0 or target == 1000.0 - x[2]:
        return [1.0, math.nan, x[2] + 1], _outputs(p, [0.0, 0.0], 0.0, 0)
    if target == 74.0:
        return [1.0], _outputs(p, [0.0, 0.0], 0.0, 0)
    if target == 75.0:
        return x, {"nearest.x": 1.0}
    if target == 76.0:
        return None
    found = tools(x0=x[:2], p=[target + level(d, t), u["target.y"], p["product"]], lbg=0, ubg=0)
    if target == 77.0 or not tools.stats()["success"]:
        raise ValueError(f"no nearest point found: {tools.stats()['return_status']}; move the target")
    point = found["x"].full().ravel()
    return [*point, x[2] + 1], _outputs(p, point, level(d, t), x[2] + 1)


def _outputs(p, point, height, count):
    sign = -1.0 if p["mirrored"] else 1.0
    return {"nearest.x": point[0], "nearest.y": sign * point[1], "level": height, "count": count}
