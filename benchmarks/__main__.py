"""`python -m benchmarks`: every figure of speed in one table, as ratios against a peer or a floor of the same run.

`--rounds 1` makes it quick, to see that everything runs; its figures mean little.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator

from rich.live import Live
from rich.table import Table

from benchmarks import (
    closed_loop,
    exchange,
    formation_scaling,
    isolation,
    local_problem,
    mpc_sample,
    planning,
    plant_kernel,
    qp_in_fmu,
    qp_solvers,
)
from cosim.engine.models import find

Row = tuple[str, str, str, str]


def main() -> None:
    """Measure on one core, where the system lets a process choose, and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description="The figures of speed, as ratios.")
    parser.add_argument("--rounds", type=_positive, help="rounds of every figure (default: enough to trust them)")
    rounds = parser.parse_args().rounds
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    table = Table("what", "value", "against", "aim")
    modules = (isolation, formation_scaling, planning, local_problem, qp_solvers, qp_in_fmu, mpc_sample)
    before = _load()
    with Live(table, auto_refresh=False) as shown:
        for rows in (_exchange(rounds), _kernel(rounds), _loop(rounds), *(module.rows(rounds) for module in modules)):
            for row in rows:
                table.add_row(*row)
                shown.refresh()
            table.add_section()
        table.caption = before and f"load average {before} before and {_load()} after, on {os.cpu_count()} cores"
    if not shown.console.is_terminal:
        shown.console.line()


def _load() -> str:
    """Of the last minute, where the system tells."""
    return f"{os.getloadavg()[0]:.1f}" if hasattr(os, "getloadavg") else ""


def _positive(text: str) -> int:
    if int(text) < 1:
        raise ValueError
    return int(text)


def _exchange(rounds: int | None) -> Iterator[Row]:
    seen = exchange.measure(find("Vehicle16Dof"), rounds=rounds or exchange.ROUNDS)
    against = f"{seen['exchange']:.1f} us / {seen['reference']:.1f} us of an empty PythonFMU slave with the same ports"
    yield "Vehicle16Dof: set + 1 ms step + get", f"{seen['ratio']:.2f}", against, "<= 2.0"


def _kernel(rounds: int | None) -> Iterator[Row]:
    seen = plant_kernel.measure(rounds or plant_kernel.ROUNDS)
    against = f"{seen['kernel']:.1f} us / {seen['mujoco']:.1f} us of MuJoCo's RK4, same tree without tyres"
    yield "plant kernel: one RK4 step with tyres", f"{seen['ratio']:.2f}", against, "<= 0.6"


def _loop(rounds: int | None) -> Iterator[Row]:
    seen = closed_loop.measure(rounds=rounds or closed_loop.ROUNDS)
    yield "high-speed-tracking, recorder on", f"{seen.real_time_factor:.1f}", "real time", "25, at least 15"
    yield "share of the master", f"{seen.share['master']:.1%}", "wall time of the run", "< 25 %"
    for name, microseconds in seen.microseconds_per_call.items():
        yield f"  {name}", f"{seen.share[name]:.1%}", f"wall time of the run; {microseconds:.1f} us per exchange", ""


if __name__ == "__main__":
    main()
