"""Rules of the life cycle, continued: calls out of order are refused and do no damage."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from operator import methodcaller

from fmukit.conformance.bare import host
from fmukit.conformance.bench import Bench
from fmukit.conformance.disturbance import disturbed
from fmukit.conformance.rule import NotApplicable, Rules
from fmukit.conformance.trying import first, limits
from fmukit.conformance.variable import ScalarVariable

RULES: Rules[Bench] = Rules()
_TERMINATED = 3
_ORDER = (
    ("ExitInitializationMode", "instantiated"),
    ("Terminate", "instantiated"),
    ("EnterInitializationMode", "initialisation"),
    ("Terminate", "initialisation"),
    ("EnterInitializationMode", "stepping"),
    ("ExitInitializationMode", "stepping"),
)


@RULES.add(
    "L9",
    "DoStep is refused outside the stepping state",
    "good practice",
    "remember the state of the instance; refuse fmi2DoStep with a message before initialisation and after terminate",
)
def step_in_its_place(bench: Bench) -> Iterator[str]:
    experiment = bench.experiment
    for state in ("instantiated", "initialisation", "terminated"):
        yield from disturbed(
            bench, f"fmi2DoStep in the state '{state}'", state, methodcaller("step", experiment.start, experiment.step)
        )


@RULES.add(
    "L10",
    "Changes of state out of order are refused",
    "good practice",
    "remember the state of the instance; refuse to enter or leave initialisation or to terminate out of order",
)
def order(bench: Bench) -> Iterator[str]:
    for name, state in _ORDER:
        yield from disturbed(bench, f"fmi2{name} in the state '{state}'", state, methodcaller("call", name))


@RULES.add(
    "L11",
    "Nothing can be set after terminate",
    "4.2.4",
    "refuse fmi2SetXXX with a message after fmi2Terminate",
)
def set_after_terminate(bench: Bench) -> Iterator[str]:
    for variable in first([*bench.select("input", "Real"), *bench.select("parameter", "Real")], 1):
        yield from _set(bench, variable, "terminated", "after terminate")


@RULES.add(
    "L12",
    "Steps that do not go forward are refused",
    "good practice",
    "refuse fmi2DoStep with a step that is zero, negative, infinite or not a number",
)
def impossible_steps(bench: Bench) -> Iterator[str]:
    time = bench.experiment.start + 5 * bench.experiment.step
    for size in (0.0, -bench.experiment.step, math.nan, math.inf):
        what = f"a step of {size:g} s"
        yield from disturbed(bench, what, "stepping", methodcaller("step", time, size))


@RULES.add(
    "L13",
    "Outputs and fixed parameters cannot be set during the run",
    "good practice",
    "refuse fmi2SetXXX on outputs, and on fixed parameters once initialised, with a message",
)
def set_what_is_fixed(bench: Bench) -> Iterator[str]:
    fixed = [v for v in bench.select("parameter", "Real") if v.variability == "fixed"]
    for variable in [*first(bench.select("output", "Real"), 3), *first(fixed, 3)]:
        yield from _set(bench, variable, "stepping", f"during the run ({variable.causality})")


@RULES.add(
    "L14",
    "Value references that do not exist are refused",
    "good practice",
    "check value references before using them as an index",
)
def unknown_references(bench: Bench) -> Iterator[str]:
    beyond = max((v.vr for v in bench.package.variables), default=0) + 1000
    for reference in (beyond, 2**32 - 1):
        what = f"getting the Real variable of value reference {reference}"
        yield from disturbed(bench, what, "stepping", partial(_get, reference))
        what = f"setting the Real variable of value reference {reference}"
        yield from disturbed(bench, what, "stepping", methodcaller("set", "Real", [reference], [0.0]))


@RULES.add(
    "L15",
    "A GUID of another model is refused",
    "2.1.5",
    "compare the GUID given to fmi2Instantiate with that of the model description; return no instance if they differ",
)
def wrong_guid(bench: Bench) -> Iterator[str]:
    if bench.package.python:
        raise NotApplicable("the binary of PythonFMU does not look at the GUID, which no Python code can mend")
    wrong = "{00000000-0000-0000-0000-000000000000}"
    instance = host.RawInstance(replace(bench.target, guid=wrong))
    if instance.component:
        yield f"fmi2Instantiate returns an instance for the GUID {wrong}"
        instance.free()


@RULES.add(
    "L16",
    "After a discarded step the FMU says whether it has ended the simulation",
    "4.2.3",
    "let fmi2GetBooleanStatus(fmi2Terminated) answer fmi2OK with true or false, or fmi2Discard if it cannot tell",
)
def word_after_discard(bench: Bench) -> Iterator[str]:
    instance = bench.lead("stepping")
    time, status = bench.experiment.start + 5 * bench.experiment.step, host.OK
    for size in (0.0, -bench.experiment.step, math.nan):
        status = max(status, instance.step(time, size))
        if status > host.WARNING:
            break
    if status == host.FATAL:
        raise NotApplicable("an impossible step is answered with fatal")
    if status == host.DISCARD:
        yield from _terminated(instance)
    instance.free()
    if status != host.DISCARD:
        raise NotApplicable("it discards no step")


def _terminated(instance: host.RawInstance) -> Iterator[str]:
    value = ctypes.c_int(-1)
    status = instance.call("GetBooleanStatus", ctypes.c_int(_TERMINATED), ctypes.byref(value))
    if status not in (host.OK, host.WARNING, host.DISCARD):
        yield f"fmi2GetBooleanStatus(fmi2Terminated) answers {host.word(status)} after a step that was discarded"
    elif status != host.DISCARD and value.value not in (0, 1):
        yield f"fmi2GetBooleanStatus(fmi2Terminated) gives {value.value}, which is neither true nor false"


def _get(reference: int, instance: host.RawInstance) -> int:
    return instance.get("Real", [reference])[0]


def _set(bench: Bench, variable: ScalarVariable, state: str, when: str) -> Iterator[str]:
    """Setting another permitted value than the present one."""

    def act(instance: host.RawInstance) -> int:
        _, (value,) = instance.get(variable.fmi_type, [variable.vr])
        return instance.set(variable.fmi_type, [variable.vr], [_another(variable, value)])

    yield from disturbed(bench, f"setting {variable.name} {when}", state, act)


def _another(variable: ScalarVariable, value: float) -> float:
    low, high = limits(variable)
    other = value + 0.5 * (variable.nominal or abs(value) or 1.0)
    return other if other <= high else 0.5 * (max(low, -1e3) + value)
