"""What an FMU shows: its variables, its kind and its step. No mathematics, no FMI calls, no casadi.

Every component declares one `Interface`. The order of its variables is the order of the slots in the instance's
buffer, and the FMI value reference of a variable is its slot: parameters first, then inputs, then outputs.
"""

from __future__ import annotations

import math
import re
import tomllib
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

Causality = Literal["parameter", "input", "output"]
Type = Literal["Real", "Integer", "Boolean", "String"]
Kind = Literal["continuous", "sampled"]
Value = float | int | bool | str

AXES = ("x", "y", "z")
_NAME = re.compile(r"[a-z_][a-z0-9_]*(\[\d+])?(\.[a-z_][a-z0-9_]*(\[\d+])?)*")
_SEEDS = 2**31
_TOML_KEYS = {"value", "unit", "min", "max", "description", "source"}


@dataclass(frozen=True, slots=True)
class Variable:
    """One scalar variable. `unit` is "1" for a pure number; `minimum`/`maximum` are inclusive and enforced."""

    name: str
    causality: Causality
    unit: str
    description: str
    start: Value = 0.0
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None
    type: Type = "Real"
    source: str = ""

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name):
            raise ValueError(f"variable name {self.name!r} is not a lower_snake structured name")
        if not self.description:
            raise ValueError(f"variable {self.name} has no description")
        if self.type == "String":
            return
        low = -math.inf if self.minimum is None else self.minimum
        high = math.inf if self.maximum is None else self.maximum
        if not low <= float(self.start) <= high:
            raise ValueError(f"variable {self.name}: start {self.start} is outside [{low}, {high}]")


@dataclass(frozen=True, slots=True)
class Table:
    """A numeric CSV file read at initialisation, named by the String parameter `parameter` (empty: no file).

    `rows` is the capacity; with `increasing` the first column must increase strictly.
    """

    parameter: str
    columns: tuple[str, ...]
    rows: int
    increasing: bool = True


@dataclass(frozen=True, slots=True)
class Advice:
    """A sentence the FMU logs as a warning when `output` is above 0.5 after initialisation, which then goes on.

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
    user after initialisation where it applies.
    """

    name: str
    description: str
    kind: Kind
    step: float
    variables: tuple[Variable, ...]
    max_substep: float = math.inf
    noise: int = 0
    table: Table | None = None
    advice: tuple[Advice, ...] = ()

    def __post_init__(self) -> None:
        names = [variable.name for variable in self.variables]
        twice = sorted({name for name in names if names.count(name) > 1})
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
    table: Table | None = None,
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


def parameter(
    name: str,
    unit: str,
    description: str,
    start: Value,
    *,
    minimum: float | None = None,
    maximum: float | None = None,
    source: str = "",
) -> Variable:
    """A fixed parameter; a bool start makes it Boolean, a str start makes it String."""
    type_: Type = "Boolean" if isinstance(start, bool) else "String" if isinstance(start, str) else "Real"
    return Variable(name, "parameter", unit, description, start, minimum, maximum, type=type_, source=source)


def input_(
    name: str,
    unit: str,
    description: str,
    start: float = 0.0,
    *,
    minimum: float | None = None,
    maximum: float | None = None,
    nominal: float | None = None,
) -> Variable:
    """A Real input."""
    return Variable(name, "input", unit, description, start, minimum, maximum, nominal)


def output(name: str, unit: str, description: str, *, nominal: float | None = None) -> Variable:
    """A Real output; its value after initialisation is calculated."""
    return Variable(name, "output", unit, description, nominal=nominal)


def group(
    make: Callable[..., Variable], name: str, members: Iterable[str], unit: str, text: str, **options: object
) -> list[Variable]:
    """`make` (`input_`, `output`) once per member: group(input_, "force", AXES, "N", "external force")."""
    return [make(f"{name}.{member}", unit, f"{text}, {member}", **options) for member in members]


def load_parameters(path: Path) -> tuple[Variable, ...]:
    """Parameters from a TOML file of entries `"name" = {value, unit, description, source, min, max}`.

    Raises ValueError naming the file and the entry when a key is missing or unknown.
    """
    return tuple(_from_toml(path, name, entry) for name, entry in tomllib.loads(path.read_text("utf-8")).items())


def _from_toml(path: Path, name: str, entry: dict[str, object]) -> Variable:
    if not isinstance(entry, dict):
        raise ValueError(f'{path.name}: {name} must be a table like {{value = 1.0, unit = "m", ...}}')
    unknown, missing = entry.keys() - _TOML_KEYS, {"value", "unit", "description", "source"} - entry.keys()
    if unknown or missing:
        raise ValueError(f"{path.name}: {name} has unknown keys {sorted(unknown)} and lacks {sorted(missing)}")
    value = entry["value"]
    start = value if isinstance(value, bool | str) else float(value)  # type: ignore[arg-type]
    return parameter(
        name,
        str(entry["unit"]),
        str(entry["description"]),
        start,
        minimum=entry.get("min"),  # type: ignore[arg-type]
        maximum=entry.get("max"),  # type: ignore[arg-type]
        source=str(entry["source"]),
    )
