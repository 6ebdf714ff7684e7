"""The interface of a component: its variables, its kind and its step, the table it reads and the advice it gives."""

from __future__ import annotations

import math
import re
import zlib
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from fmukit.interface.variable import Causality, Variable, parameter

Kind = Literal["continuous", "sampled"]

_SEEDS = 2**31


@dataclass(frozen=True, slots=True)
class CsvTable:
    """A numeric CSV file read at initialisation, named by the String parameter `parameter` (empty: no file).

    `rows` is the capacity; with `increasing` the first column must increase strictly. `names` are other names that the
    columns may have, in another order and after a #.
    """

    parameter: str
    columns: tuple[str, ...]
    rows: int
    increasing: bool = True
    names: Mapping[str, str] = field(default_factory=dict, hash=False)


@dataclass(frozen=True, slots=True)
class Advice:
    """A sentence the FMU logs as a warning when `output` rises above 0.5, at initialisation or later; it then goes on.

    `{name}` in the text is replaced by the value of the Real parameter of that name.
    """

    output: str
    text: str

    @property
    def parameters(self) -> tuple[str, ...]:
        """The parameters whose values the text shows."""
        return tuple(re.findall(r"\{([^{}]*)}", self.text))


@dataclass(frozen=True, slots=True)
class Interface:
    """A component's face: `step` is the default communication step [s]; build with `continuous` or `sampled`.

    A continuous component integrates in substeps no longer than `max_substep` [s]. A noisy one receives `noise`
    unit normals at initialisation and at every sample, drawn from (`seed`, sample index). `advice` is given to the
    user where it applies.
    """

    name: str
    description: str
    kind: Kind
    step: float
    variables: tuple[Variable, ...]
    max_substep: float = math.inf
    noise: int = 0
    table: CsvTable | None = None
    advice: tuple[Advice, ...] = ()

    def __post_init__(self) -> None:
        names = Counter(variable.name for variable in self.variables)
        twice = sorted(name for name, count in names.items() if count > 1)
        if twice:
            raise ValueError(f"{self.name} declares {', '.join(twice)} more than once")
        for advice in self.advice:
            _check_advice(self, advice)

    def select(self, causality: Causality) -> tuple[Variable, ...]:
        """Variables of one causality in slot order, `fault` among the outputs."""
        return tuple(variable for variable in self.variables if variable.causality == causality)

    def names(self, causality: Causality) -> tuple[str, ...]:
        """Names in slot order; of the outputs all but `fault`, which belongs to the runtime."""
        return tuple(v.name for v in self.select(causality) if (causality, v.name) != ("output", "fault"))


def _check_advice(interface: Interface, advice: Advice) -> None:
    """ValueError for advice on an output, or with a parameter, that is not a Real one of the interface."""
    outputs = {variable.name for variable in interface.select("output") if variable.type == "Real"}
    parameters = {variable.name for variable in interface.select("parameter") if variable.type == "Real"}
    unknown = sorted(({advice.output} - outputs) | (set(advice.parameters) - parameters))
    if unknown:
        raise ValueError(f"{interface.name} gives advice on {', '.join(unknown)}, which it does not declare as Real")


def continuous(
    name: str,
    description: str,
    *,
    step: float,
    max_substep: float,
    variables: Iterable[Variable],
    advice: Iterable[Advice] = (),
) -> Interface:
    """A component that integrates over the step it is given (a plant)."""
    ordered = _ordered(variables)
    return Interface(name, description, "continuous", step, ordered, max_substep=max_substep, advice=tuple(advice))


def sampled(
    name: str,
    description: str,
    *,
    step: float,
    variables: Iterable[Variable],
    noise: int = 0,
    table: CsvTable | None = None,
    periods: tuple[float, float] = (1e-6, 1e3),
    advice: Iterable[Advice] = (),
) -> Interface:
    """A component that computes on its own grid of `sample_period` and holds its outputs in between.

    `periods`: shortest and longest `sample_period` [s] it may be given.
    """
    low, high = periods
    extra = [
        parameter("sample_period", "s", "sampling period of the component's own grid", step, minimum=low, maximum=high)
    ]
    if noise:
        extra.append(
            Variable(
                "seed",
                "parameter",
                "1",
                "seed of the noise",
                _seed(name),
                minimum=0,
                maximum=_SEEDS - 1,
                type="Integer",
            )
        )
    ordered = _ordered([*variables, *extra])
    return Interface(name, description, "sampled", step, ordered, noise=noise, table=table, advice=tuple(advice))


def _seed(name: str) -> int:
    """Another default for every model, so that sensors side by side do not draw the same noise."""
    return zlib.crc32(name.encode()) % _SEEDS


def _ordered(variables: Iterable[Variable]) -> tuple[Variable, ...]:
    fault = Variable("fault", "output", "1", "true while the last step was refused or failed", False, type="Boolean")
    rank = {"parameter": 0, "input": 1, "output": 2}
    return tuple(sorted([*variables, fault], key=lambda variable: rank[variable.causality]))
