"""Rules of behaviour, continued: values that make no sense are refused; text is only text."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

from fmukit.conformance.bare import host
from fmukit.conformance.bench import Bench, formatting
from fmukit.conformance.disturbance import attempt, disturbed, verdict
from fmukit.conformance.rule import NotApplicable, Rules
from fmukit.conformance.trying import first
from fmukit.conformance.variable import ScalarVariable

RULES: Rules[Bench] = Rules()
_MOST = 60
_FORMAT = "100%s%s%s%s%n%d"
Case = tuple[ScalarVariable, float]


@RULES.add(
    "B11",
    "NaN and infinity are refused",
    "good practice",
    "check that every Real value set is finite; refuse it with a message and keep the old value",
)
def not_finite(bench: Bench) -> Iterator[str]:
    _, inputs, parameters = _real(bench)
    values = (math.nan, math.inf, -math.inf)
    yield from _refused(bench, "stepping", [(v, values[k % 3]) for k, v in enumerate(inputs)])
    yield from _refused(bench, "instantiated", [(v, values[k % 3]) for k, v in enumerate(parameters)])


@RULES.add(
    "B12",
    "Values outside min and max are refused",
    "good practice",
    "compare every value set with the declared min and max; refuse it with a message and keep the old value",
)
def out_of_range(bench: Bench) -> Iterator[str]:
    everything, inputs, parameters = _real(bench)
    if all(v.min is None and v.max is None for v in everything):
        raise NotApplicable("no input or parameter declares min or max")
    yield from _refused(bench, "stepping", [case for v in inputs for case in _outside(v)])
    integers = [v for v in bench.select("parameter", "Integer") if v.settable_before_start and v.type == "Integer"]
    yield from _refused(bench, "instantiated", [case for v in [*parameters, *integers] for case in _outside(v)])


def _real(bench: Bench) -> tuple[list[ScalarVariable], list[ScalarVariable], list[ScalarVariable]]:
    inputs = list(first(bench.select("input", "Real"), _MOST))
    parameters = list(first([v for v in bench.select("parameter", "Real") if v.settable_before_start], _MOST))
    if not inputs and not parameters:
        raise NotApplicable("it has neither Real inputs nor Real parameters")
    return inputs + parameters, inputs, parameters


def _outside(variable: ScalarVariable) -> Iterator[Case]:
    if variable.max is not None and variable.max < (2**31 - 1 if variable.type == "Integer" else 1e300):
        yield variable, variable.max + (1 if variable.type == "Integer" else 1e-3 * max(1.0, abs(variable.max)))
    if variable.min is not None and variable.min > (-(2**31) if variable.type == "Integer" else -1e300):
        yield variable, variable.min - (1 if variable.type == "Integer" else 1e-3 * max(1.0, abs(variable.min)))


def _refused(bench: Bench, state: str, cases: Sequence[Case]) -> Iterator[str]:
    """Each case on one instance; those that are not refused at once get an instance and the next call to object."""
    late: list[Case] = []

    def all_at_once(instance: host.RawInstance) -> int:
        worst = host.OK
        for variable, value in cases:
            status, said = attempt(instance, _setting(variable, value))
            if status <= host.WARNING and not said:
                late.append((variable, value))
            worst = max(worst, status)
            if worst >= host.ERROR:
                break
        return worst

    if not cases:
        return
    probe = bench.lead(state)
    status = all_at_once(probe)
    if status == host.FATAL:
        yield from verdict(f"setting such a value in the state '{state}'", status, True)
        return
    probe.free()
    if status >= host.ERROR or late:
        for variable, value in (late or cases)[:6]:
            yield from disturbed(
                bench, f"{variable.name} = {value:g}", state, _objecting(bench, variable, value, state)
            )
    else:
        yield from disturbed(bench, "setting such values", state, all_at_once)


def _setting(variable: ScalarVariable, value: float) -> Callable[[host.RawInstance], int]:
    return lambda instance: instance.set(variable.fmi_type, [variable.vr], [value])


def _objecting(bench: Bench, variable: ScalarVariable, value: float, state: str) -> Callable[[host.RawInstance], int]:
    """Set the value and, if that is not refused, make the call that would use it."""

    def act(instance: host.RawInstance) -> int:
        status, said = attempt(instance, _setting(variable, value))
        if status > host.WARNING or said:
            return status
        if state == "stepping":
            return instance.step(bench.experiment.start + 5 * bench.experiment.step, bench.experiment.step)
        instance.enter(bench.experiment.start)
        return instance.call("ExitInitializationMode")

    return act


@RULES.add(
    "B20",
    "Texts are UTF-8",
    "2.1.2",
    "let fmi2GetString give a pointer to characters encoded in UTF-8 and ended by a zero, never a null pointer",
)
def texts(bench: Bench) -> Iterator[str]:
    strings = [v for v in bench.package.variables if v.type == "String"]
    if not strings:
        raise NotApplicable("it has no String variables")
    instance = bench.lead("stepping")
    for variable in first(strings, _MOST):
        status, (text,) = instance.get("String", [variable.vr])
        if status <= host.WARNING:
            yield from (f"{variable.name} is {what}" for what in _unreadable(text))
    instance.free()


def _unreadable(text: bytes | None) -> Iterator[str]:
    if text is None:
        yield "a null pointer"
        return
    try:
        text.decode("utf-8")
    except UnicodeDecodeError as error:
        yield f"{text[:40]!r}, whose byte {error.start} is not UTF-8"


@RULES.add(
    "B13",
    "A % in a text is not taken for a format",
    "2.1.5",
    'hand text to the logger as logger(..., "%s", text), or double each %: hosts treat the message as a printf format',
)
def percent(bench: Bench) -> Iterator[str]:
    texts = [v for v in bench.package.variables if v.type == "String" and v.settable_before_start]
    if not texts:
        raise NotApplicable("it has no String parameters or inputs")
    for variable in texts[:3]:
        instance = host.made(bench.target, "formatted", formatting)
        worst = _until_refused(bench, instance, variable)
        for _, message in instance.messages:
            if "100" in message and _FORMAT not in message:
                yield f"with {variable.name} = {_FORMAT!r} the message reads {message!r}"
        if worst != host.FATAL:
            instance.free()


def _until_refused(bench: Bench, instance: host.RawInstance, variable: ScalarVariable) -> int:
    """Set the text and take the first step; stops at the first refusal, since no other call may follow it."""
    start = bench.experiment.start
    calls: tuple[Callable[[], int], ...] = (
        lambda: instance.set("String", [variable.vr], [_FORMAT]),
        lambda: instance.setup(start),
        lambda: instance.call("EnterInitializationMode"),
        lambda: instance.call("ExitInitializationMode"),
        lambda: instance.step(start, bench.experiment.step),
    )
    return next((status for call in calls if (status := call()) > host.WARNING), host.OK)
