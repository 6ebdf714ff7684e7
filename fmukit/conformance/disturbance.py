"""A call that must be refused: does the FMU say so, and is it unharmed afterwards?

Refused means: the call answers discard or error, or a message of at least a warning is logged (a host made of Python
cannot return a status from every call). Unharmed means: outputs stay, and the rest of the run has the numbers of a run
that was never disturbed. The FMU may answer with discarding the next step once; after an error it is reset first, as
the standard has it. Answering fatal is a failure: the host would have to end the whole process.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from fmukit.conformance.bare import host
from fmukit.conformance.bench import RESETS, Bench

Act = Callable[[host.RawInstance], int]


def disturbed(bench: Bench, what: str, state: str, act: Act) -> Iterator[str]:
    """Lead an instance to `state`, do what must be refused, and finish the run."""
    bench.reference()  # without one there is nothing to compare with
    instance = bench.lead(state)
    before = _values(bench, instance, state)
    status, said = attempt(instance, act)
    yield from verdict(what, status, said)
    if status == host.FATAL:
        return  # not even freeing the instance is allowed any more
    if not (status > host.WARNING or said):
        instance.free()
        return
    if status < host.ERROR and _values(bench, instance, state) != before:
        yield f"{what} is refused but changes outputs all the same"
    yield from unharmed(bench, instance, state, status, what)


def attempt(instance: host.RawInstance, act: Act) -> tuple[int, bool]:
    """The status of `act` and whether a warning or worse was logged."""
    count = len(instance.messages)
    status = act(instance)
    return status, any(level >= host.WARNING and text for level, text in instance.messages[count:])


def verdict(what: str, status: int, said: bool) -> Iterator[str]:
    """What is wrong with the answer to a call that must be refused; `said`: a warning or worse was logged."""
    if status == host.FATAL:
        yield f"{what} is answered with fatal: the host must end, although nothing irreparable happened"
    elif status <= host.WARNING and not said:
        yield f"{what} is accepted: status {host.word(status)} and no message"


def unharmed(bench: Bench, instance: host.RawInstance, state: str, status: int, what: str) -> Iterator[str]:
    """Finish the run (after a reset if `status` is an error) and compare; frees the instance."""
    resets = status >= host.ERROR or state == "terminated"
    if resets and any(_after_resets(bench).values()):
        instance.free()  # a rule of its own says that reset does not work
        return
    if status >= host.ERROR:
        instance.must("Reset")
        state = "instantiated"
    seen = bench.finish(instance, state)
    changed = bench.difference(seen, bench.reference()[-len(seen) :])
    if changed:
        yield f"after {what} the run is no longer that of an undisturbed instance: {changed}"
    instance.free()


def _after_resets(bench: Bench) -> dict[str, str]:
    """What resets leave behind; where one instance at a time is allowed, only what is known already."""
    once = bench.package.flag("canBeInstantiatedOnlyOncePerProcess")
    return bench.known(RESETS, {}) if once else bench.after_resets()


def _values(bench: Bench, instance: host.RawInstance, state: str) -> str:
    """The outputs but the Booleans (one of them may signal the fault), where they may be read."""
    if state != "stepping":
        return ""
    return repr([x for v, x in zip(bench.outputs, instance.outputs(), strict=True) if v.type != "Boolean"])
