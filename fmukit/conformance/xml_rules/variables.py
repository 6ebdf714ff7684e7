"""Names, value references and the table of causality, variability and initial."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping

from fmukit.conformance.package import Package
from fmukit.conformance.rule import NotApplicable, Rules
from fmukit.conformance.variable import ScalarVariable
from fmukit.conformance.xml_rules.group import reliable

RULES: Rules[Package] = Rules(reliable)
_BASIC = r"(?:[A-Za-z_]\w*|'(?:[\w!#$%&()*+,\-./:;<>=?@\[\]^{}|~ ]|\\['\"?\\abfnrtv])+')"
_PART = rf"{_BASIC}(?:\[\d+(?:,\d+)*\])?"
_PATH = rf"{_PART}(?:\.{_PART})*"
_STRUCTURED = re.compile(rf"{_PATH}|der\({_PATH}(?:,\d+)?\)", re.ASCII)
_MOVING = {"discrete", "continuous"}
_VARIABILITY: Mapping[str, set[str]] = {
    "parameter": {"fixed", "tunable"},
    "calculatedParameter": {"fixed", "tunable"},
    "input": _MOVING,
    "output": {"constant", *_MOVING},
    "local": {"constant", "fixed", "tunable", *_MOVING},
    "independent": {"continuous"},
}


@RULES.add("X22", "Variables have names of their own", "2.2.7", "Give every variable another, non-empty name.")
def _unique(package: Package) -> Iterator[str]:
    names = Counter(variable.name for variable in package.variables)
    yield from (f"{count} variables have the name {name!r}" for name, count in names.items() if count > 1)
    yield from (f"variable {v.index} has the name {v.name!r}" for v in package.variables if not v.name.strip())


@RULES.add(
    "X23",
    "Structured names follow their grammar",
    "2.2.9",
    "Write names like body.wheel[2].speed or der(x): letters, digits and _, anything else in single quotes; "
    'or declare variableNamingConvention="flat".',
)
def _structured(package: Package) -> Iterator[str]:
    if package.root.get("variableNamingConvention", "flat") != "structured":
        raise NotApplicable("names are flat")
    for variable in package.variables:
        if variable.name.strip() and not _STRUCTURED.fullmatch(variable.name):
            yield f"{variable.name!r} is no structured name"


@RULES.add(
    "X24",
    "Integer, Boolean, String and Enumeration variables are not continuous",
    "2.2.7",
    'Write variability="discrete" (or fixed, tunable, constant) at the variable; left out, it means continuous.',
)
def _continuous(package: Package) -> Iterator[str]:
    for variable in package.variables:
        if variable.type != "Real" and variable.variability == "continuous":
            how = "by default" if "variability" not in variable.given else "explicitly"
            yield f"the {variable.type} variable {variable.name} is continuous {how}"


@RULES.add(
    "X25",
    "Causality and variability go together",
    "2.2.7",
    "Parameters are fixed or tunable, inputs discrete or continuous, outputs constant, discrete or continuous.",
)
def _combination(package: Package) -> Iterator[str]:
    for variable in package.variables:
        if not _legal(variable):
            yield f"variable {variable.name} has causality {variable.causality} with variability {variable.variability}"


@RULES.add(
    "X26",
    "initial is one the causality and variability allow",
    "2.2.7",
    "Constants and parameters are exact, calculated parameters and fixed locals approx or calculated; "
    "inputs and the independent variable have no initial at all.",
)
def _initial(package: Package) -> Iterator[str]:
    for variable in package.variables:
        if "initial" in variable.given and _legal(variable) and variable.initial not in _initials(variable):
            kind = f"{variable.variability} {variable.causality}"
            yield f"variable {variable.name} has initial {variable.initial}, which a {kind} must not have"


@RULES.add(
    "X27",
    "There is at most one independent variable, a Real without a start value",
    "2.2.7",
    "Keep one variable of causality independent (time), of type Real; the others are outputs or locals.",
)
def _independent(package: Package) -> Iterator[str]:
    found = [variable for variable in package.variables if variable.causality == "independent"]
    if len(found) > 1:
        yield f"{', '.join(variable.name for variable in found)} are all independent"
    yield from (f"the independent variable {v.name} is {v.type}" for v in found if v.type != "Real")


@RULES.add(
    "X28",
    "Variables that share a value reference are true aliases",
    "2.2.7",
    "Give one of the variables another valueReference; aliases have one unit and one start value, "
    "and at most one of them may be set.",
)
def _aliases(package: Package) -> Iterator[str]:
    shared: dict[tuple[str, int], list[ScalarVariable]] = defaultdict(list)
    for variable in package.variables:
        shared["Integer" if variable.type == "Enumeration" else variable.type, variable.vr].append(variable)
    for (type_, vr), aliases in shared.items():
        if len(aliases) > 1 and (reason := _conflict(aliases)):
            names = ", ".join(variable.name for variable in aliases)
            yield f"the {type_} variables {names} share valueReference {vr} but {reason}"


@RULES.add(
    "X29",
    "derivative names a continuous Real variable",
    "2.2.7",
    "Let derivative be the index of the state, counted from 1 in the order of ModelVariables.",
)
def _derivative(package: Package) -> Iterator[str]:
    for variable in package.variables:
        if variable.derivative is None:
            continue
        if not 1 <= variable.derivative <= len(package.variables) or variable.derivative == variable.index:
            yield f"variable {variable.name} has derivative {variable.derivative}, which is no other variable"
            continue
        state = package.variables[variable.derivative - 1]
        if (state.type, state.variability) != ("Real", "continuous"):
            yield f"variable {variable.name} is the derivative of {state.name}, a {state.variability} {state.type}"


@RULES.add(
    "X46",
    "canHandleMultipleSetPerTimeInstant stands at inputs of model exchange only",
    "2.2.7",
    "Take canHandleMultipleSetPerTimeInstant out: it must not stand in an FMU for co-simulation only, or elsewhere.",
)
def _multiple_set(package: Package) -> Iterator[str]:
    exchange = package.root.find("ModelExchange") is not None
    for variable in package.variables:
        if "canHandleMultipleSetPerTimeInstant" not in variable.given:
            continue
        if not exchange:
            yield f"variable {variable.name} has it, but the FMU is not for model exchange"
        elif variable.causality != "input":
            yield f"variable {variable.name} has it, but its causality is {variable.causality}"


def _legal(variable: ScalarVariable) -> bool:
    return variable.variability in _VARIABILITY[variable.causality] or (
        variable.type != "Real" and variable.variability == "continuous"  # told by another rule
    )


def _initials(variable: ScalarVariable) -> set[str]:
    if variable.causality in ("input", "independent"):
        return set()
    if variable.causality == "parameter" or variable.variability == "constant":
        return {"exact"}
    if variable.variability in ("fixed", "tunable"):
        return {"approx", "calculated"}
    return {"exact", "approx", "calculated"}


def _conflict(aliases: list[ScalarVariable]) -> str:
    settable = [v.name for v in aliases if v.causality in ("parameter", "input")]
    if len(settable) > 1:
        return f"{' and '.join(settable)} can all be set"
    if len({v.unit for v in aliases}) > 1:
        return f"have the units {', '.join(sorted(str(v.unit) for v in aliases))}"
    if len({v.start for v in aliases if v.start is not None}) > 1:
        return "have different start values"
    if len({v.variability == "constant" for v in aliases}) > 1:
        return "only some of them are constant"
    return ""
