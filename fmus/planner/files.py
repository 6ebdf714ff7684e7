"""Files a plan is written to: found fit before the search, written after it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path

from fmus.planner.errors import PlanningError
from fmus.planner.gates import Array


def check_outputs(outputs: Sequence[Path], road: Path | None = None) -> None:
    """Raise PlanningError when two outputs are the same file, one is the road's own, or one cannot be written."""
    for first, second in combinations(outputs, 2):
        if _same(first, second):
            raise PlanningError(f"trajectory and forces cannot both be written to {first}; name two files")
    for file in outputs:
        if road is not None and _same(file, road):
            raise PlanningError(f"{file} is the road itself, which the plan would replace; name another file")
        _check_writable(file)


def write_table(columns: Sequence[str], rows: Array, file: Path) -> None:
    """Write rows (n, len(columns)) as CSV with a header; raises PlanningError when the file cannot be written."""
    lines = [",".join(columns), *(",".join(f"{value:.9g}" for value in row) for row in rows)]
    try:
        file.write_text("\n".join(lines) + "\n", "utf-8")
    except OSError as error:
        raise _unwritable(file, error) from error


def _same(first: Path, second: Path) -> bool:
    """Also through links, and by names that differ only for us."""
    try:
        return first.samefile(second)
    except OSError:
        return first.resolve() == second.resolve()


def _check_writable(file: Path) -> None:
    """Open the file without changing it; one that was not there is not left behind."""
    there = file.exists()
    try:
        file.open("ab").close()
        if not there:
            file.unlink()
    except OSError as error:
        raise _unwritable(file, error) from error


def _unwritable(file: Path, error: OSError) -> PlanningError:
    return PlanningError(f"{file} cannot be written ({error.strerror}); name another file")
