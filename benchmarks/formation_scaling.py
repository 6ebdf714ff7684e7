"""What one more car costs: time per car and simulated second, and memory, of formations of 1 to 50 full cars.

Every formation runs in a process of its own, recorder on. Its cost is the processor time of the loop, so that it does
not grow with what else the machine does; the sizes take turns, and the least of several rounds counts. Memory is the
most the process ever held, start to summary. One car alone is the head, which plans its way and hears nobody; all
others hear a radio and follow.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import process_time

from cosim.run import Request, run
from cosim.scenarios import load

SIZES = (1, 2, 5, 10, 20, 50)
ROUNDS = 3
RATIO, MEMORY, REAL_TIME = 1.15, 3.0, 2.0
"""At most, of the largest formation to one car; at most [MB] per further car; at least, of `CARS` cars."""
CARS = 10
_SCENARIO = "formation-adaptive"
_WORK = 40.0  # cars times simulated seconds of one run, but within:
_SHORTEST, _LONGEST = 2.0, 20.0  # [s]


@dataclass(frozen=True, slots=True)
class Run:
    """`processor` and `wall` time [s] per car and simulated second, most `memory` [MB] (NaN where it is not told)."""

    cars: int
    processor: float
    wall: float
    memory: float


@dataclass(frozen=True, slots=True)
class Formation:
    """The best of the runs of one size: `cost` [s] per car and simulated second, `ratio` to that of the smallest.

    `memory` [MB] per car more than the smallest; `real_time_factor` of all cars together, on one core.
    """

    cost: float
    ratio: float
    memory: float
    real_time_factor: float


def measure(rounds: int = ROUNDS, sizes: Sequence[int] = SIZES) -> dict[int, Formation]:
    """Formations by number of cars, ascending; the sizes take turns in every round."""
    _elsewhere(max(sizes), 0.1)  # builds what is not in the cache
    runs = [_elsewhere(cars, seconds(cars)) for _ in range(rounds) for cars in sorted(sizes)]
    return compared(runs)


def seconds(cars: int) -> float:
    """How long [s] a formation runs: about equal work, whatever the number of cars."""
    return min(max(_WORK / cars, _SHORTEST), _LONGEST)


def compared(runs: Sequence[Run]) -> dict[int, Formation]:
    """The best of each size beside the best of the smallest; memory is best where it is least, too."""
    sizes = sorted({run.cars for run in runs})
    cost, wall, memory = (_least(runs, name) for name in ("processor", "wall", "memory"))
    one = sizes[0]
    return {
        cars: Formation(
            cost=cost[cars],
            ratio=cost[cars] / cost[one],
            memory=(memory[cars] - memory[one]) / (cars - one) if cars > one else float("nan"),
            real_time_factor=1.0 / (cars * wall[cars]),
        )
        for cars in sizes
    }


def _least(runs: Sequence[Run], name: str) -> Mapping[int, float]:
    return {cars: min(getattr(run, name) for run in runs if run.cars == cars) for cars in {run.cars for run in runs}}


def rows(rounds: int | None) -> list[tuple[str, str, str, str]]:
    """For the table of `python -m benchmarks`."""
    return [_row(cars, seen) for cars, seen in measure(rounds or ROUNDS).items()]


def _row(cars: int, seen: Formation) -> tuple[str, str, str, str]:
    factor = f"{seen.real_time_factor:.1f} x real time on one core"
    more = "" if cars == SIZES[0] else f"{seen.ratio:.2f} x one car, {seen.memory:.1f} MB per further car, "
    aims = {SIZES[-1]: f"<= {RATIO:g} x, <= {MEMORY:g} MB", CARS: f">= {REAL_TIME:g} x real time"}
    plural = "s" if cars > 1 else ""
    what = f"formation of {cars} car{plural}, 16-DoF, radio: car and second"
    return what, f"{1e3 * seen.cost:.1f} ms", more + factor, aims.get(cars, "")


def _elsewhere(cars: int, duration: float) -> Run:
    line = [sys.executable, "-m", "benchmarks.formation_scaling", str(cars), str(duration)]
    done = subprocess.run(line, cwd=Path(__file__).parents[1], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"a formation of {cars} cars did not run: {done.stderr[-2000:]}")
    return Run(**json.loads(done.stdout))


def _here(cars: int, duration: float) -> Run:
    """Run the formation in this process, which is used for nothing else."""
    marks: list[tuple[int, float]] = []  # simulated [ns], processor time [s]
    with tempfile.TemporaryDirectory() as folder:
        request = Request(load(_SCENARIO), Path(folder), [("scenario.vehicles", str(cars))], stop_time=duration)
        summary, _ = run(request, progress=lambda time: marks.append((time, process_time())))
    if summary["status"] != "ok":
        raise RuntimeError(f"{_SCENARIO} with {cars} cars: {summary['reason']}")
    (first, start), (last, end) = marks[0], marks[-1]
    processor = (end - start) / ((last - first) / 1e9)
    return Run(cars, processor / cars, summary["wall_time"] / duration / cars, _most_memory())


def _most_memory() -> float:
    """The largest resident set of this process [MB], where Linux tells."""
    status = Path("/proc/self/status")
    if not status.is_file():
        return float("nan")
    (line,) = [line for line in status.read_text().splitlines() if line.startswith("VmHWM")]
    return float(line.split()[1]) / 1024.0


if __name__ == "__main__":
    print(json.dumps(asdict(_here(int(sys.argv[1]), float(sys.argv[2])))))
