"""Time-optimal plans of the double lane change: compiled against interpreted derivatives and against plain CasADi.

The peer is the same problem as a user of CasADi would write it, with `Opti` and the derivatives CasADi finds itself.
Fatrop, an interior-point solver made for such programs, meets IPOPT in the time that each takes for itself, without
the derivatives, which both call alike.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median
from time import perf_counter, process_time
from typing import Any

from benchmarks.planning_peers import CAR, ENDS, HOW, ROAD, Run, fatrop, opti
from fmus.planner import compiled, gate_grid, guess, time_grid
from fmus.planner.hocp import Grid
from fmus.planner.program import Nodes, NonlinearProgram
from fmus.planner.search import ipopt_options

ROUNDS = 7
AIMS: dict[tuple[Grid, int], float] = {("gate", 80): 0.10, ("gate", 160): 0.30, ("time", 80): 0.40}
"""Most that a plan may take after compilation [s]."""


@dataclass(frozen=True, slots=True)
class Timed:
    """Of several rounds: wall time `seconds`, `worst` and processor time `processor`, both medians but for the worst.

    `own` is the solver's share of the processor time, without derivatives; `final_time` [s] of the plan.
    """

    seconds: float
    worst: float
    processor: float
    own: float
    iterations: int
    final_time: float


@dataclass(frozen=True, slots=True)
class Figures:
    """Of one mesh: our plan `compiled` and `interpreted`; `opti` and `fatrop` on the gate grid only."""

    compiled: Timed
    interpreted: Timed
    opti: Timed | None = None
    fatrop: Timed | None = None


def measure(grid: Grid, m: int, rounds: int = ROUNDS, *, peers: bool = False) -> Figures:
    """Plan `rounds` times compiled and at most twice in every slower way; all must find the same end time."""
    program, first = _program(grid, m)
    few = min(rounds, 2)
    figures = Figures(
        _timed(_planner(program, first, compile_=True), rounds),
        _timed(_planner(program, first, compile_=False), few),
        _timed(opti(m, first), few) if peers else None,
        _timed(fatrop(m, first), few) if peers else None,
    )
    for peer in (figures.interpreted, figures.opti, figures.fatrop):
        if peer is not None and abs(peer.final_time - figures.compiled.final_time) > 1e-4:
            raise RuntimeError(f"the end times differ: {peer.final_time} and {figures.compiled.final_time} s")
    return figures


def _timed(run: Run, rounds: int) -> Timed:
    wall, processor, own = [], [], []
    for _ in range(rounds):
        start = perf_counter(), process_time()
        stats, final_time = run()
        wall.append(perf_counter() - start[0])
        processor.append(process_time() - start[1])
        own.append(processor[-1] - sum(value for name, value in stats.items() if name.startswith("t_proc_nlp")))
    return Timed(median(wall), max(wall), median(processor), median(own), int(stats["iter_count"]), final_time)


def _program(grid: Grid, m: int) -> tuple[NonlinearProgram, Nodes]:
    """Our program and where the search begins."""
    gates = ROAD.gates(m)
    first = guess.along_gates(CAR, gates, ENDS)
    if grid == "gate":
        return gate_grid.program(CAR, gates, ENDS, substeps=HOW.substeps, smoothing=HOW.smoothing), first
    program = time_grid.program(CAR, ROAD, m, ENDS, substeps=HOW.substeps, smoothing=HOW.smoothing)
    return program, guess.on_equal_times(first)


def _planner(program: NonlinearProgram, first: Nodes, *, compile_: bool) -> Run:
    options = ipopt_options(HOW.max_iterations, HOW.tolerance, warm=False)
    solver = compiled.solver(program, options, compile_=compile_)
    if compile_ and solver.how != "compiled":
        raise RuntimeError(f"the derivatives are {solver.how}")
    bounds = {"lbx": program.lower, "ubx": program.upper, "lbg": program.g_lower, "ubg": program.g_upper}

    def run() -> tuple[dict[str, Any], float]:
        found = solver.call(x0=program.pack(first), p=program.parameters, **bounds)
        return solver.call.stats(), float(program.unpack(found["x"].full().ravel()).times[-1])

    return run


def rows(rounds: int | None) -> Iterator[tuple[str, str, str, str]]:
    """What `python -m benchmarks` prints."""
    for (grid, m), aim in AIMS.items():
        seen = measure(grid, m, rounds or ROUNDS, peers=(grid, m) == ("gate", 80))
        ours, slow = seen.compiled, seen.interpreted
        against = f"wall time, median; worst {ours.worst:.3f} s; processor {ours.processor:.3f} s, median"
        yield f"plan, {grid} grid, m = {m}, compiled", f"{ours.seconds:.3f} s", against, f"<= {aim:.2f} s"
        yield _ratio("  compiled against interpreted", ours.seconds, slow.seconds, "wall time", "< 1")
        if seen.opti and seen.fatrop:
            yield _ratio("  compiled against plain CasADi", ours.seconds, seen.opti.seconds, "with Opti", "< 1")
            yield _ratio("  IPOPT against fatrop", ours.own, seen.fatrop.own, "processor, without derivatives", "<= 1")


def _ratio(what: str, ours: float, peer: float, against: str, aim: str) -> tuple[str, str, str, str]:
    return what, f"{ours / peer:.2f}", f"{ours:.3f} s / {peer:.3f} s {against}", aim


if __name__ == "__main__":
    for row in rows(None):
        print("  |  ".join(row))
