"""Pass limits: what a run has to keep to, or its mission is missed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from cosim.scenario.metric import Metric


@dataclass(frozen=True, slots=True)
class Limit:
    """The metric named `metric` is to be at most `most` and at least `least`, in its unit.

    `words` say what has happened where it is not: "left the road".
    """

    words: str
    metric: str
    most: float = math.inf
    least: float = -math.inf


@dataclass(frozen=True, slots=True)
class Verdict:
    """A limit and the `value` that was held against it; `kept` is None where that is not known."""

    limit: Limit
    value: float
    unit: str
    kept: bool | None

    @property
    def text(self) -> str:
        """E.g. "corridor_violation_max = 0.31 m, at most 0.05 m"."""
        unit = "" if self.unit == "1" else f" {self.unit}"
        bounds = {"at most": self.limit.most, "at least": self.limit.least}
        said = [f"{word} {bound:g}{unit}" for word, bound in bounds.items() if math.isfinite(bound)]
        value = f"{self.value:.3g}{unit}" if self.kept is not None else "unknown"
        return f"{self.limit.metric} = {value}, {' and '.join(said)}"


def judged(limits: Sequence[Limit], metrics: Mapping[str, Metric]) -> list[Verdict]:
    """A verdict per limit; raises KeyError where there is no such metric, a mistake of the scenario's author."""
    return [_verdict(limit, metrics[limit.metric]) for limit in limits]


def _verdict(limit: Limit, metric: Metric) -> Verdict:
    known = not math.isnan(metric.value)
    return Verdict(limit, metric.value, metric.unit, limit.least <= metric.value <= limit.most if known else None)


def missed(verdicts: Sequence[Verdict]) -> str:
    """One sentence on the limits that were not kept; empty where all were."""
    return "; ".join(f"{v.limit.words} ({v.text})" for v in verdicts if v.kept is False)
