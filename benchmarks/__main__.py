"""`python -m benchmarks`: every figure of speed in one table, as ratios against a peer or a floor of the same run."""

from __future__ import annotations

import os
from collections.abc import Iterator

from rich.console import Console
from rich.table import Table

from benchmarks import closed_loop, exchange, plant_kernel
from cosim.scenarios._catalogue import fmu_path

Row = tuple[str, str, str, str]


def main() -> None:
    """Measure on one core, where the system lets a process choose, and print."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    table = Table("what", "value", "against", "aim")
    for rows in (_exchange(), _kernel(), _loop()):
        for row in rows:
            table.add_row(*row)
        table.add_section()
    Console().print(table)


def _exchange() -> Iterator[Row]:
    seen = exchange.measure(fmu_path("Vehicle16Dof"))
    against = f"{seen['exchange']:.1f} us / {seen['reference']:.1f} us of an empty PythonFMU slave with the same ports"
    yield "Vehicle16Dof: set + 1 ms step + get", f"{seen['ratio']:.2f}", against, "<= 2.0"


def _kernel() -> Iterator[Row]:
    seen = plant_kernel.measure()
    against = f"{seen['kernel']:.1f} us / {seen['mujoco']:.1f} us of MuJoCo's RK4, same tree without tyres"
    yield "plant kernel: one RK4 step with tyres", f"{seen['ratio']:.2f}", against, "<= 0.6"


def _loop() -> Iterator[Row]:
    seen = closed_loop.measure()
    yield "high-speed-tracking, recorder on", f"{seen.real_time_factor:.1f}", "real time", "25, at least 15"
    yield "share of the master", f"{seen.share['master']:.1%}", "wall time of the run", "< 25 %"
    for name, microseconds in seen.microseconds_per_call.items():
        yield f"  {name}", f"{seen.share[name]:.1%}", f"wall time of the run; {microseconds:.1f} us per exchange", ""


if __name__ == "__main__":
    main()
