"""Rules of behaviour: repeatable, true to what is declared, and a function of time rather than of calls."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import isclose, isfinite

from fmukit.conformance.bare import host
from fmukit.conformance.bench import Bench
from fmukit.conformance.rule import NotApplicable, Rules
from fmukit.conformance.trying import limits
from fmukit.conformance.variable import ScalarVariable, Value

RULES: Rules[Bench] = Rules()
_SHRINK = 1.2
_WRITTEN = 1e-13  # tools write start values with 15 digits or more
_NOISE = 1e-4
_TYPES = ("Real", "Integer", "Boolean", "String")


@RULES.add(
    "B1",
    "Two runs give the same numbers, bit for bit",
    "good practice",
    "let random numbers come from a seed that is a parameter, use no clock, and initialise all memory",
)
def determinism(bench: Bench) -> Iterator[str]:
    one, other = bench.runs_alone()
    changed = bench.difference(one, other)
    if changed:
        yield f"two runs in processes of their own differ: {changed}"


@RULES.add(
    "B2",
    "Start values are respected",
    "2.2.7",
    "let a new instance have the start values of the model description in all variables with initial=exact",
)
def start_values(bench: Bench) -> Iterator[str]:
    instance = bench.lead("initialisation")
    for variable in bench.package.variables:
        exact = variable.initial == "exact" or variable.causality == "input"
        if not exact or variable.start is None:
            continue
        status, (value,) = instance.get(variable.fmi_type, [variable.vr])
        if status > host.WARNING:
            yield f"{variable.name} cannot be read: {host.word(status)}"
        elif not _equal(variable, value, variable.start):
            yield f"{variable.name} is {_plain(value)!r}, its declared start value is {variable.start!r}"
    bench.dismiss(instance, "initialisation")


@RULES.add(
    "B3",
    "Outputs are finite",
    "good practice",
    "give outputs a finite value at the start, and look for a division by zero or an unstable equation",
)
def finite(bench: Bench) -> Iterator[str]:
    rows = bench.life(bench.experiment)
    for position, variable in enumerate(bench.outputs):
        k = next((k for k, row in enumerate(rows) if not isfinite(row[position])), None)
        if k is not None:
            yield f"{variable.name} is {rows[k][position]} at {bench.experiment.start + k * bench.experiment.step:g} s"


@RULES.add(
    "B4",
    "What is set can be read back",
    "2.1.7",
    "let fmi2GetXXX return exactly what fmi2SetXXX stored, also before initialisation",
)
def round_trips(bench: Bench) -> Iterator[str]:
    settable = [v for v in bench.package.variables if v.settable_before_start]
    changes = [
        {v: _another(v) for v in settable if v.type == type_ and v.causality in ("parameter", "input")}
        for type_ in _TYPES
    ]
    found = [_round_trip(bench, wanted) for wanted in changes if wanted]
    if found and all(seen is None for seen in found):
        raise NotApplicable("it does not initialise with values other than its start values")
    for seen in found:
        yield from seen or ()


def _round_trip(bench: Bench, wanted: dict[ScalarVariable, Value]) -> list[str] | None:
    """What is wrong with values set together; None if the FMU refuses them, as it may: a text can name a file."""
    instance, seen = bench.lead("instantiated"), []
    for variable, value in wanted.items():
        status = instance.set(variable.fmi_type, [variable.vr], [value])
        if status > host.WARNING:
            what = f"{variable.name} = {value!r} before initialisation is answered with {host.word(status)}"
            return _refusal(instance, status, None if variable.type == "String" else [what])
    instance.expect("fmi2SetupExperiment", instance.setup(bench.experiment.start))
    status = instance.call("EnterInitializationMode")
    if status > host.WARNING:
        return _refusal(instance, status, None)
    for variable, value in wanted.items():
        _, (read,) = instance.get(variable.fmi_type, [variable.vr])
        if not _equal(variable, read, value):
            seen.append(f"{variable.name} was set to {value!r} and reads back as {_plain(read)!r}")
    bench.dismiss(instance, "initialisation")
    return seen


def _refusal(instance: host.RawInstance, status: int, seen: list[str] | None) -> list[str] | None:
    """Free the instance after a refusal; after fatal not even that is allowed."""
    if status == host.FATAL:
        return ["a value that differs from the start value is answered with fatal"]
    instance.free()
    return seen


def _another(variable: ScalarVariable) -> Value:
    """A permitted value that is not the start value and not a short binary number."""
    start = variable.start
    if variable.type == "String":
        return "another text: äß"
    if variable.type == "Boolean":
        return not start
    low, high = limits(variable)
    if variable.type == "Integer":
        return int(start or 0) + 1 if int(start or 0) < high else int(low)
    value = float(start or 0.0)
    aside = 0.0123456789 * (variable.nominal or abs(value) or 1.0)
    return next((other for other in (value + aside, value - aside) if low <= other <= high), low)


def _equal(variable: ScalarVariable, value: object, wanted: object) -> bool:
    if variable.type == "Real":
        return isclose(float(value), float(wanted), rel_tol=_WRITTEN, abs_tol=0.0)  # type: ignore[arg-type]
    if variable.type == "Boolean":
        return bool(value) == bool(wanted)
    return bool(_plain(value) == wanted)


def _plain(value: object) -> object:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


@RULES.add(
    "B5",
    "Sampled outputs do not depend on how the host cuts time into steps",
    "4.2.2",
    "sample on a grid of accumulated time, not once per fmi2DoStep: a host may take half or double steps",
)
def step_size_invariance(bench: Bench) -> Iterator[str]:
    if bench.continuous or not bench.select("output", "Real"):
        raise NotApplicable("it has no outputs that are all sampled")
    bench.requires("canHandleVariableCommunicationStepSize", "it takes steps of one size only")
    bench.reference()  # without one there is nothing to compare with
    held = _held(bench.experiment, 2)
    expected = _at_ends(bench, held, 2)
    for parts, words in ((4, "half steps"), (1, "double steps"), (6, "thirds of a step")):
        changed = bench.difference(_at_ends(bench, held, parts), expected)
        if changed:
            yield f"with {words} of the host the samples change: {_doubled(changed)}"


@RULES.add(
    "B6",
    "Continuous outputs converge as the host's steps shrink",
    "4.2.2",
    "integrate over the step given, with inner steps short enough; do not count calls",
)
def convergence(bench: Bench) -> Iterator[str]:
    if not bench.continuous:
        raise NotApplicable("it has no continuous outputs")
    bench.requires("canHandleVariableCommunicationStepSize", "it takes steps of one size only")
    bench.reference()
    declared = bench.package.root.find("DefaultExperiment")
    tolerance = 0.0 if declared is None else float(declared.get("tolerance", 0.0))
    once, twice, often = (_at_ends(bench, bench.experiment, parts) for parts in (1, 2, 4))
    for position, variable in enumerate(bench.outputs):
        if variable.type != "Real" or variable.variability != "continuous":
            continue
        columns = [[float(row[position]) for row in rows] for rows in (once, twice, often)]
        yield from _converges(variable, columns, max(tolerance, _NOISE))


def _converges(variable: ScalarVariable, columns: list[list[float]], noise: float) -> Iterator[str]:
    """Halving the steps again must change the output less than halving once, down to what an integrator may err."""
    once, twice, often = columns
    scale = max(map(abs, often), default=0.0) + 1e-12
    coarse = max(abs(a - b) for a, b in zip(once, twice, strict=True))
    fine = max(abs(a - b) for a, b in zip(twice, often, strict=True))
    if not fine <= max(coarse / _SHRINK, noise * scale):
        yield (
            f"{variable.name} changes by {coarse:.3g} when the steps are halved and by {fine:.3g} when they are "
            "halved again"
        )


def _held(experiment: host.Experiment, count: int) -> host.Experiment:
    """The experiment of `count` times the step, with inputs held as long."""
    return host.Experiment(experiment.start, count * experiment.step, experiment.rows[::count])


def _at_ends(bench: Bench, experiment: host.Experiment, parts: int) -> list[host.Row]:
    """The outputs at the ends of the experiment's steps, each of which is cut into `parts`."""
    rows = tuple(row for row in experiment.rows for _ in range(parts))
    return bench.life(replace(experiment, step=experiment.step / parts, rows=rows))[parts::parts]


def _doubled(sentence: str) -> str:
    """`difference` counts in steps of the experiment; the time it names does not hold for other steps."""
    return sentence.partition(" s ")[2] or sentence
