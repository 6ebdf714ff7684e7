"""What the fuzzer draws for one FMU: legal values and lists of variables, and odd ones."""

from __future__ import annotations

import math
from collections.abc import Sequence

from hypothesis import strategies as st
from raw_fmi import Variable

TYPES = ("Real", "Integer", "Boolean", "String")
ODD_REALS = (math.nan, math.inf, -math.inf, 0.0, -0.0, 1e300, -1e300, 5e-324, 1.0)
# Bytes that are not UTF-8 are left out: PythonFMU itself answers fatal, after which the standard allows no call.
ODD_TEXTS = (b"", b"%s%n%s", "\u017e\U0001f600".encode(), b"/no/such.csv", b"x" * 300, None)
ODD_REFERENCES = (10**4, 2**31 - 1, 2**31, 2**32 - 1)
STEPS = (1.0, 1.0, 1.0, 0.3, 2.5, 10.0)
ODD_STEPS = (0.0, -0.0, -1e-3, 1e-13, 5e-324, math.nan, math.inf, -math.inf, 1e8, 1e9, 1.1e9, 1e300)
ODD_TIMES = (math.nan, math.inf, -math.inf, 1e13, -1e13, 1e300, -1e300)


def _bound(limit: float | None, unlimited: float) -> float:
    return unlimited if limit is None else limit


def legal(variable: Variable) -> st.SearchStrategy[object]:
    """Values inside the declared limits, the limits and the start value among them."""
    if variable.type == "Boolean":
        return st.booleans()
    if variable.type == "String":
        return st.sampled_from(ODD_TEXTS[:5])
    low, high = _bound(variable.low, -1e6), _bound(variable.high, 1e6)
    if variable.type == "Integer":
        return st.integers(int(low), int(min(high, 2**31 - 1)))
    known = [low, high] if variable.start is None else [low, high, float(variable.start)]
    return st.one_of(st.sampled_from(known), st.floats(low, high))


def any_value(type_: str) -> st.SearchStrategy[object]:
    if type_ == "Real":
        return st.one_of(st.sampled_from(ODD_REALS), st.floats())
    if type_ == "String":
        return st.sampled_from(ODD_TEXTS)
    return st.sampled_from((0, 1, -1, 7, 2**31 - 1, -(2**31)))


class Draws:
    """The strategies of one FMU."""

    def __init__(self, variables: Sequence[Variable]) -> None:
        inputs = [v for v in variables if v.causality == "input"]
        settable = [v for v in variables if v.causality != "output"]
        unique = {"max_size": 4, "unique_by": lambda v: v.vr}
        self.settable = st.lists(st.sampled_from(settable), min_size=1, **unique)
        self.inputs = st.lists(st.sampled_from(inputs), **unique) if inputs else st.just([])
        anything = st.lists(
            st.one_of(st.sampled_from([v.vr for v in variables]), st.sampled_from(ODD_REFERENCES)), max_size=3
        )
        self.references = {
            type_: st.one_of(
                st.lists(st.sampled_from([v.vr for v in variables if v.type == type_] or [0]), max_size=4), anything
            )
            for type_ in TYPES
        }
