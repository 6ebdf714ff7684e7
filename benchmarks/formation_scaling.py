"""What one more car costs: time per car and simulated second, and memory, of formations of 1 to 50 full cars.

Every formation runs in a process of its own, recorder on, all over the same simulated time, in which the head weaves
and speeds up. They take turns, so that whatever else the machine does slows all of them down alike. The cost is the
processor time of the loop, of which each turn counts as it went in its best round; beside it stands the median of what
the rounds gave, each compared within itself. Memory is the resident set of a process: the most from start to summary,
and what it was when all instances were initialised. One car alone is the head, which has a reference and hears nobody;
all others hear a radio.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from benchmarks.spread import spread
from cosim.run.request import Request
from cosim.run.running import run
from scenarios.formation import ADAPTIVE

SIZES = (1, 2, 5, 10, 20, 50)
ROUNDS = 3
RATIO, MEMORY, REAL_TIME = 1.15, 3.0, 2.0
"""At most, of the largest formation to one car; at most [MB] per further car; at least, of `CARS` cars."""
CARS = 10
_TURNS = 20
_TURN = 15 * 64_000_000  # [ns], a multiple of the time between two calls of `progress`


@dataclass(frozen=True, slots=True)
class Run:
    """`processor` and `wall` time [s] per car and simulated second, turn by turn; most `memory` [MB] held, or NaN.

    `initialised` is what was held [MB] when the instances were there and had run a few ticks, or NaN.
    """

    cars: int
    processor: Sequence[float]
    wall: Sequence[float]
    memory: float
    initialised: float


@dataclass(frozen=True, slots=True)
class Formation:
    """The runs of one size: best `cost` [s] per car and simulated second, and its `ratio` to that of the smallest size.

    `usual` is the median over the rounds of that ratio, `second` the best ratio to the next size: the smallest that
    hears a radio. `memory` [MB] per car more than the smallest, `instances` that of initialised ones; the real-time
    factor `seen`, the load of the machine included.
    """

    cars: int
    cost: float
    ratio: float
    usual: float
    second: float
    memory: float
    instances: float
    seen: float

    @property
    def real_time_factor(self) -> float:
        """Of all cars together on a core they have for themselves."""
        return 1.0 / (self.cars * self.cost)


def measure(rounds: int = ROUNDS, sizes: Sequence[int] = SIZES) -> dict[int, Formation]:
    """Formations by number of cars."""
    _here(2, turns=1, wait=lambda: None, length=64_000_000)  # builds what is not in the cache
    return compared([_together(sorted(sizes)) for _ in range(rounds)])


def compared(rounds: Sequence[Sequence[Run]]) -> dict[int, Formation]:
    """Every size beside the first one, by number of cars; each round has a run of every size."""
    sizes = list(zip(*rounds, strict=True))
    return {runs[0].cars: _formation(runs, sizes[0], sizes[1 % len(sizes)]) for runs in sizes}


def _formation(runs: Sequence[Run], ones: Sequence[Run], twos: Sequence[Run]) -> Formation:
    cost, one, two = (spread([run.processor for run in each]).best_mean for each in (runs, ones, twos))
    rounds = [np.mean(run.processor) / np.mean(first.processor) for run, first in zip(runs, ones, strict=True)]
    return Formation(
        runs[0].cars,
        cost=cost,
        ratio=cost / one,
        usual=float(np.median(rounds)),
        second=cost / two,
        memory=_per_car(runs, ones, lambda run: run.memory),
        instances=_per_car(runs, ones, lambda run: run.initialised),
        seen=1.0 / (runs[0].cars * min(float(np.mean(run.wall)) for run in runs)),
    )


def _per_car(runs: Sequence[Run], ones: Sequence[Run], memory: Callable[[Run], float]) -> float:
    more = runs[0].cars - ones[0].cars
    return (min(map(memory, runs)) - min(map(memory, ones))) / more if more else float("nan")


def rows(rounds: int | None) -> list[tuple[str, str, str, str]]:
    """For the table of `python -m benchmarks`."""
    return [_row(cars, seen) for cars, seen in measure(rounds or ROUNDS).items()]


def _row(cars: int, seen: Formation) -> tuple[str, str, str, str]:
    factor = f"{seen.real_time_factor:.1f} x real time on a core of its own, {seen.seen:.1f} seen"
    times = f"{seen.ratio:.2f} x one car (usually {seen.usual:.2f}), {seen.second:.2f} x two; "
    memory = f"{seen.memory:.1f} MB per further car, {seen.instances:.1f} of it initialised; "
    more = "" if cars == SIZES[0] else times + memory
    aims = {SIZES[-1]: f"<= {RATIO:g} x, <= {MEMORY:g} MB", CARS: f">= {REAL_TIME:g} x real time"}
    plural = "s" if cars > 1 else ""
    what = f"formation of {cars} car{plural}, 16-DoF, radio: car and second"
    return what, f"{1e3 * seen.cost:.1f} ms", more + factor, aims.get(cars, "")


def _together(sizes: Sequence[int]) -> list[Run]:
    """All sizes at once, one at a time: each goes on when it is given a line, and gives one when its turn is over."""
    processes = [_process(cars) for cars in sizes]
    try:
        for process in processes:
            _answer(process)
        for _ in range(_TURNS):
            for process in processes:
                _go_on(process)
                _answer(process)
        for process in processes:
            _go_on(process)
        return [Run(**json.loads(_answer(process))) for process in processes]
    finally:
        for process in processes:
            process.kill()
            process.communicate()


def _process(cars: int) -> subprocess.Popen[str]:
    line = [sys.executable, "-m", "benchmarks.formation_scaling", str(cars)]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(line, cwd=Path(__file__).parents[1], text=True, **pipes)  # type: ignore[call-overload,no-any-return]


def _go_on(process: subprocess.Popen[str]) -> None:
    assert process.stdin is not None
    process.stdin.write("\n")
    process.stdin.flush()


def _answer(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    line = process.stdout.readline()
    if not line:
        raise RuntimeError(f"a formation did not run: {process.communicate()[1][-2000:]}")
    return line


def _wait() -> None:
    print(flush=True)
    sys.stdin.readline()


class _Turns:
    """The progress of a run that waits before and after every turn; what they took: simulated, processor, wall [s]."""

    def __init__(self, turns: int, wait: Callable[[], None], length: int) -> None:
        self.length = length
        self.initialised = float("nan")
        self.taken: list[tuple[float, float, float]] = []
        self._turns, self._wait = turns, wait
        self._start: tuple[int, float, float] | None = None

    def __call__(self, time: int) -> None:
        if self._start is None:  # after the first ticks
            self.initialised = _memory("VmRSS")
            self._begin(time)
        elif len(self.taken) < self._turns and time - self._start[0] >= self.length:
            begin, processor, wall = self._start
            self.taken.append(((time - begin) / 1e9, process_time() - processor, perf_counter() - wall))
            self._begin(time)

    def _begin(self, time: int) -> None:
        self._wait()
        self._start = time, process_time(), perf_counter()


def _here(cars: int, turns: int, wait: Callable[[], None], length: int = _TURN) -> Run:
    """Run the formation in this process; `wait` is called before every turn of `length` [ns] and after the last."""
    taken = _Turns(turns, wait, length)
    stop = (turns * length + 2 * 64_000_000) / 1e9
    with tempfile.TemporaryDirectory() as folder:
        request = Request(ADAPTIVE, Path(folder), [("scenario.vehicles", str(cars))], stop_time=stop)
        summary = run(request, progress=taken).summary
    if summary.status != "ok":
        raise RuntimeError(f"{ADAPTIVE.name} with {cars} cars: {summary.reason}")
    simulated, processor, wall = np.array(taken.taken).T
    costs = [(spent / simulated / cars).tolist() for spent in (processor, wall)]
    return Run(cars, *costs, memory=_memory("VmHWM"), initialised=taken.initialised)


def _memory(kind: str) -> float:
    """The resident set of this process [MB], where Linux tells: the present one VmRSS, the largest VmHWM."""
    status = Path("/proc/self/status")
    if not status.is_file():
        return float("nan")
    (line,) = [line for line in status.read_text().splitlines() if line.startswith(kind)]
    return float(line.split()[1]) / 1024.0


def _print(rounds: int) -> None:
    for row in rows(rounds):
        print("  |  ".join(row), flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--rounds"] or not sys.argv[1:]:
        _print(int(sys.argv[2]) if sys.argv[1:] else ROUNDS)
    else:
        print(json.dumps(asdict(_here(int(sys.argv[1]), _TURNS, _wait))))
