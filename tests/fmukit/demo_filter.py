"""A noisy sampled component with a table: first-order filter of a measured value. For tests of fmukit only."""

from __future__ import annotations

import casadi as ca

from fmukit.component import Component
from fmukit.interface import CsvTable, input_, output, parameter, sampled
from fmukit.kernel import Kernel, Layout, Parts, Signals, sampled_kernel

ROWS = 6
INTERFACE = sampled(
    "DemoFilter",
    "First-order filter of a noisy measurement, with a profile from a file",
    step=5e-3,
    noise=3,
    table=CsvTable("profile_file", ("time", "level"), ROWS),
    variables=[
        parameter("time_constant", "s", "time constant of the filter", 0.05, minimum=1e-3),
        parameter("sigma", "m", "standard deviation of the noise", 0.1, minimum=0.0),
        parameter("profile_file", "1", "CSV file of the profile; empty for none", ""),
        input_("measured", "m", "measured value", minimum=-1e6, maximum=1e6),
        output("filtered", "m", "filtered value"),
        output("noise", "m", "noise of this sample"),
        output("level", "m", "profile value at the sampling instant"),
        output("quotient", "1", "not finite where measured is 77 or 1000 + count"),
        output("count", "1", "number of samples so far"),
    ],
)
COMPONENT = Component(INTERFACE, "demo_filter")


def kernel() -> Kernel:
    states, derived = Layout(z=1, n=1), Layout(table=2 * ROWS, rows=1)
    return sampled_kernel(INTERFACE, states=states, derived=derived, initialise=initialise, sample=sample)


def initialise(p: Signals, w: ca.SX, table: ca.SX, rows: ca.SX) -> tuple[Parts, Parts, Parts]:
    first = p["sigma"] * w[0]
    y = {"filtered": first, "noise": first, "level": level(table, rows, ca.SX(0))}
    return {"table": ca.vec(table), "rows": rows}, {"z": first}, y


def sample(p: Signals, d: Parts, u: Signals, x: Parts, w: ca.SX, t: ca.SX) -> tuple[Parts, Parts]:
    noise = p["sigma"] * (w[0] + w[1] * w[2])
    decay = ca.exp(-p["sample_period"] / p["time_constant"])
    z = decay * x["z"] + (1 - decay) * (u["measured"] + noise)
    y = {
        "filtered": z,
        "noise": noise,
        "level": level(ca.reshape(d["table"], 2, ROWS), d["rows"], t),
        "quotient": 1 / ((u["measured"] - 77) * (u["measured"] - 1000 - x["n"])),
        "count": x["n"] + 1,
    }
    return {"z": z, "n": x["n"] + 1}, y


def level(table: ca.SX, rows: ca.SX, t: ca.SX) -> ca.SX:
    """Piecewise linear, constant outside, 0 without a file."""
    value = table[1, 0]
    for k in range(ROWS - 1):
        width = table[0, k + 1] - table[0, k]
        share = ca.fmin(ca.fmax((t - table[0, k]) / (width + (width == 0)), 0), 1)
        value = value + share * (table[1, k + 1] - table[1, k])
    return ca.if_else(rows > 0, value, 0)
