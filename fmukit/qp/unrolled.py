"""The solution with the factor L D L' as straight lines of C: its pattern is known, so no loop has to read it.

Operations and their order are those of QDLDL's loops, hence the bits too. What is saved is most of the time of an
iteration: columns of L have some five entries, so loops over them are all beginnings and ends.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence

LARGEST = 8192
"""Entries of L up to which lines are written: some 45 bytes of machine code for each."""
_PART = 200  # entries per function: a compiler takes more than linear time for a long one
_FUNCTION = """NOINLINE static void part{number}(const OSQPFloat *restrict L, const OSQPFloat *restrict D,
                                 OSQPFloat *restrict x) {{
{lines}
}}
"""
_SOLVE = """
static OSQPInt unrolled(qdldl_solver *s, OSQPVectorf *b, OSQPInt iteration) {{
  const OSQPFloat *L = s->L->x, *D = s->Dinv;
  OSQPFloat *x = s->bp, *v = b->values;
  for (OSQPInt i = 0; i < s->n + s->m; ++i) x[i] = v[s->P[i]];
{calls}
  for (OSQPInt i = 0; i < s->n + s->m; ++i) s->sol[s->P[i]] = x[i];
  for (OSQPInt i = 0; i < s->n; ++i) v[i] = s->sol[i];
  for (OSQPInt i = 0; i < s->m; ++i) v[i + s->n] += s->rho_inv_vec[i] * s->sol[i + s->n];
  return 0;
}}
"""


def with_straight_lines(workspace: str) -> str:
    """OSQP's workspace with our function in place of `solve_linsys_qdldl`, or as it is when L is large."""
    starts, rows = _numbers(workspace, "p"), _numbers(workspace, "i")
    if len(rows) > LARGEST:
        return workspace
    head, first, rest = workspace.partition("static ")
    return head + code(starts, rows) + first + rest.replace("&solve_linsys_qdldl", "&unrolled")


def code(starts: Sequence[int], rows: Sequence[int]) -> str:
    """Functions for L given by columns (`starts`, `rows`), the last of which takes the place of the solver's."""
    parts = ["\n".join(part) for part in _parts(starts, rows)]
    functions = "".join(_FUNCTION.format(number=i, lines=lines) for i, lines in enumerate(parts))
    calls = "\n".join(f"  part{i}(L, D, x);" for i in range(len(parts)))
    return f"#define NOINLINE __attribute__((noinline))\n\n{functions}{_SOLVE.format(calls=calls)}\n"


def _numbers(workspace: str, which: str) -> list[int]:
    found = re.search(rf"linsys_L_{which}\[\d+\] = \{{([^}}]*)\}}", workspace)
    if found is None:
        raise ValueError(f"OSQP's workspace has no factor's {which}; this version of osqp is not known")
    return [int(number) for number in found[1].split(",") if number.strip()]


def _parts(starts: Sequence[int], rows: Sequence[int]) -> Iterator[list[str]]:
    part: list[str] = []
    count = 0
    for line in _lines(starts, rows):
        part.append(line)
        count += line.count("L[") or 1
        if count >= _PART:
            yield part
            part, count = [], 0
    yield part


def _lines(starts: Sequence[int], rows: Sequence[int]) -> Iterator[str]:
    """Forward column by column, then backward with the division by D."""
    columns = range(len(starts) - 1)
    for i in columns:
        for k in range(starts[i], starts[i + 1]):
            yield f"  x[{rows[k]}] -= L[{k}] * x[{i}];"
    for i in reversed(columns):
        terms = "".join(f" - L[{k}] * x[{rows[k]}]" for k in range(starts[i], starts[i + 1]))
        yield f"  x[{i}] = x[{i}] * D[{i}]{terms};"
