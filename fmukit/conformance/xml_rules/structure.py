"""ModelStructure: which variables are outputs, derivatives and unknown at the start, and what they depend on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Any

from fmukit.conformance.package import Package
from fmukit.conformance.rule import NotApplicable, Rules
from fmukit.conformance.variable import ScalarVariable
from fmukit.conformance.xml_rules.group import reliable, repeated

RULES: Rules[Package] = Rules(reliable)
LISTS = ("Outputs", "Derivatives", "InitialUnknowns")


@RULES.add(
    "X37",
    "ModelStructure names variables that exist, each once per list",
    "2.2.8",
    "index counts the variables from 1 in the order of ModelVariables; keep one Unknown per variable.",
)
def _exist(package: Package) -> Iterator[str]:
    for place in LISTS:
        indices = _indices(package, place)
        yield from (f"{place} lists the index {i} more than once" for i in repeated(indices))
        for index in indices:
            if not 1 <= index <= len(package.variables):
                yield f"{place} lists the index {index}, but there are {len(package.variables)} variables"


@RULES.add(
    "X38",
    "Outputs lists exactly the output variables",
    "2.2.8",
    "Add an Unknown with the index of every variable of causality output, and of no other.",
)
def _outputs(package: Package) -> Iterator[str]:
    wanted = {variable.index for variable in package.variables if variable.causality == "output"}
    yield from _compare(package, "Outputs", wanted, ("it is an output", "it is no output"))


@RULES.add(
    "X39",
    "Derivatives lists derivatives of states",
    "2.2.8",
    "List only variables that have the attribute derivative.",
)
def _derivatives(package: Package) -> Iterator[str]:
    if not _indices(package, "Derivatives"):
        raise NotApplicable("no derivatives are exposed")
    for variable in _named(package, "Derivatives"):
        if variable.derivative is None:
            yield f"Derivatives lists {variable.name}, which has no attribute derivative"


@RULES.add(
    "X49",
    "Derivatives refer to states, each to another one",
    "2.2.8",
    "Let the attribute derivative of each listed variable be the index of its state, an output or a local variable.",
)
def _states(package: Package) -> Iterator[str]:
    listed = [v for v in _named(package, "Derivatives") if v.derivative is not None]
    for derivative, state in ((v, s) for v in listed for s in _existing(package, [v.derivative or 0])):
        if state.causality not in ("output", "local"):
            yield f"{derivative.name} refers to {state.name}, which is no state: its causality is {state.causality}"
    names = {v.index: v.name for v in package.variables}
    for index in repeated(v.derivative for v in listed):
        yield f"more than one derivative refers to {names.get(int(str(index)), index)}"


@RULES.add(
    "X40",
    "InitialUnknowns lists exactly what is unknown at the start",
    "2.2.8",
    "List every output with initial approx or calculated, every calculatedParameter, and every exposed state and "
    "derivative with initial approx or calculated; nothing else.",
)
def _initial_unknowns(package: Package) -> Iterator[str]:
    exposed = {v.index for v in _named(package, "Derivatives")}
    exposed |= {v.derivative for v in _named(package, "Derivatives") if v.derivative is not None}
    wanted = {
        variable.index
        for variable in package.variables
        if variable.causality == "calculatedParameter"
        or (
            variable.initial in ("approx", "calculated")
            and (variable.causality == "output" or variable.index in exposed)
        )
    }
    yield from _compare(package, "InitialUnknowns", wanted, ("it is unknown at the start", "it is known at the start"))


@RULES.add(
    "X41",
    "InitialUnknowns is in the order of the variables",
    "2.2.8",
    "Sort the Unknowns of InitialUnknowns by index.",
)
def _ordered(package: Package) -> Iterator[str]:
    indices = _indices(package, "InitialUnknowns")
    for before, after in pairwise(indices):
        if after < before:
            yield f"the index {after} follows {before}"


@RULES.add(
    "X42",
    "Dependencies name variables that exist, in order",
    "2.2.8",
    "Let dependencies be indices of variables, each once, smallest first.",
)
def _dependencies(package: Package) -> Iterator[str]:
    for where, _, indices in _dependent(package):
        wrong = [index for index in indices if not 1 <= index <= len(package.variables)]
        yield from (f"{where} depends on the index {index}, which is no variable" for index in wrong)
        if indices != sorted(set(indices)):
            yield f"{where} has the dependencies {' '.join(map(str, indices))}, not each once in order"


@RULES.add(
    "X43",
    "Outputs and derivatives depend on inputs, tunable parameters, states and time only",
    "2.2.8",
    "Take other variables off dependencies; during the run only inputs, tunable parameters, exposed states and the "
    "independent variable are known from outside.",
    disputed=True,
)
def _knowns(package: Package) -> Iterator[str]:
    states = {variable.derivative for variable in _named(package, "Derivatives")}
    for where, place, indices in _dependent(package):
        for variable in _existing(package, indices):
            given = variable.causality in ("input", "independent") or variable.variability == "tunable"
            known = given or variable.index in states
            if place != "InitialUnknowns" and not known:
                yield f"{where} depends on {variable.name}, a {variable.variability} {variable.causality}"


@RULES.add(
    "X44",
    "Initial unknowns depend on what is given at the start",
    "2.2.8",
    "Dependencies in InitialUnknowns are inputs, variables with initial exact and the independent variable.",
)
def _initially_known(package: Package) -> Iterator[str]:
    for where, place, indices in _dependent(package):
        for variable in _existing(package, indices):
            known = variable.causality in ("input", "independent") or variable.initial == "exact"
            if place == "InitialUnknowns" and not known:
                yield f"{where} depends on {variable.name}, whose initial is {variable.initial}"


@RULES.add(
    "X45",
    "dependenciesKind has one word per dependency",
    "2.2.8",
    "Give dependenciesKind as many words as dependencies has indices, or leave it out.",
)
def _kinds(package: Package) -> Iterator[str]:
    for place in LISTS:
        for unknown in _unknowns(package, place):
            kinds, indices = unknown.get("dependenciesKind"), unknown.get("dependencies")
            if kinds is None:
                continue
            where = f"{place}, index {unknown.get('index')}"
            if indices is None:
                yield f"{where} has dependenciesKind without dependencies"
            elif len(kinds.split()) != len(indices.split()):
                yield f"{where} has {len(indices.split())} dependencies and {len(kinds.split())} kinds"


def _unknowns(package: Package, place: str) -> list[Any]:
    return list(package.root.iterfind(f"ModelStructure/{place}/Unknown"))


def _indices(package: Package, place: str) -> list[int]:
    return [int(unknown.get("index")) for unknown in _unknowns(package, place)]


def _existing(package: Package, indices: Iterable[int]) -> list[ScalarVariable]:
    return [package.variables[index - 1] for index in indices if 1 <= index <= len(package.variables)]


def _named(package: Package, place: str) -> list[ScalarVariable]:
    return _existing(package, _indices(package, place))


def _compare(package: Package, place: str, wanted: set[int], reasons: tuple[str, str]) -> Iterator[str]:
    listed = {variable.index for variable in _named(package, place)}
    for variable in _existing(package, sorted(wanted - listed)):
        yield f"{place} lacks {variable.name} (index {variable.index}): {reasons[0]}"
    for variable in _existing(package, sorted(listed - wanted)):
        yield f"{place} lists {variable.name} (index {variable.index}), but {reasons[1]}"


def _dependent(package: Package) -> Iterator[tuple[str, str, list[int]]]:
    """Place in words, list and dependencies of every Unknown that gives them."""
    for place in LISTS:
        for unknown in _unknowns(package, place):
            text, index = unknown.get("dependencies"), int(unknown.get("index"))
            if text is not None:
                names = [variable.name for variable in _existing(package, [index])]
                yield f"{place}: {names[0] if names else index}", place, [int(i) for i in text.split()]
