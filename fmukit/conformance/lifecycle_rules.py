"""Rules of the life cycle: every legal order of calls works, for one instance and for many."""

from __future__ import annotations

from collections.abc import Iterator

from fmukit.conformance import errand
from fmukit.conformance.bare import host
from fmukit.conformance.bench import STATES, Bench
from fmukit.conformance.rule import NotApplicable, Rules

RULES: Rules[Bench] = Rules()
_LIVES = 10


@RULES.add(
    "L1",
    "An instance can be made and freed",
    "2.1.5",
    "make fmi2Instantiate return an instance and fmi2FreeInstance release it without touching anything else",
    vital=True,
)
def made_and_freed(bench: Bench) -> Iterator[str]:
    for _ in range(3):
        bench.make().free()
    yield from ()


@RULES.add(
    "L2",
    "A whole life from instantiate to free succeeds",
    "4.2.4",
    "let every call of the usual order return fmi2OK: instantiate, setupExperiment, enter and exit initialisation, "
    "steps, terminate, free",
    vital=True,
)
def whole_life(bench: Bench) -> Iterator[str]:
    bench.life(bench.experiment)
    yield from ()


@RULES.add(
    "L3",
    "An instance can be freed in every state",
    "2.1.5",
    "let fmi2FreeInstance release an instance that was never initialised or is in the middle of a run",
)
def freed_in_every_state(bench: Bench) -> Iterator[str]:
    for state in STATES:
        bench.lead(state).free()
    instance = bench.lead("stepping")
    instance.must("Reset")
    instance.free()
    yield from ()


@RULES.add(
    "L4",
    "Outputs can be read in every state after instantiation",
    "4.2.4",
    "let fmi2GetXXX succeed in initialisation mode, between steps and after terminate",
)
def read_in_every_state(bench: Bench) -> Iterator[str]:
    for state in STATES[1:]:
        instance = bench.lead(state)
        try:
            instance.outputs()
        except host.CallFailed as error:
            yield f"in the state '{state}': {error}"
        bench.dismiss(instance, state)


@RULES.add(
    "L5",
    "Reset brings every state back to a new instance",
    "2.1.6",
    "let fmi2Reset restore all variables and all hidden state to what fmi2Instantiate makes",
)
def reset(bench: Bench) -> Iterator[str]:
    for state, changed in bench.after_resets().items():
        if changed:
            yield f"reset in the state '{state}' leaves something behind: {changed}"


@RULES.add(
    "L6",
    "One life after the other gives the same numbers",
    "2.1.5",
    "keep all data in the instance; nothing of one instance may outlive it in global variables",
)
def repeated_lives(bench: Bench) -> Iterator[str]:
    reference = bench.alone()
    for number in range(1, _LIVES + 1):
        changed = bench.difference(bench.life(bench.experiment), reference)
        if changed:
            yield f"life {number} of this process differs from one in a process of its own: {changed}"
            return


@RULES.add(
    "L7",
    "Several instances at once do not disturb each other",
    "2.1.5",
    "keep all data in the instance, none in global or module variables; or declare canBeInstantiatedOnlyOncePerProcess",
)
def several_at_once(bench: Bench) -> Iterator[str]:
    if bench.package.flag("canBeInstantiatedOnlyOncePerProcess"):
        raise NotApplicable("canBeInstantiatedOnlyOncePerProcess is declared")
    changed = disturbed_by_another(bench)
    if changed:
        yield f"an instance run in turns with another one differs: {changed}"


def disturbed_by_another(bench: Bench) -> str:
    """How an instance differs that runs in turns with another one, or nothing."""
    return bench.remember("in turns", lambda: _in_turns(bench))


def _in_turns(bench: Bench) -> str:
    reference = bench.reference()
    other = bench.lead("stepping", 3)
    one = bench.lead("instantiated")
    seen = [host.initialised(one, bench.experiment)]
    for k in range(len(bench.experiment.rows)):
        seen += host.steps(one, bench.experiment.until(k + 1), k)
        if 3 + k < len(bench.experiment.rows):
            host.steps(other, bench.experiment.until(4 + k), 3 + k)
        if k == len(bench.experiment.rows) // 2:
            bench.make("passing").free()
    other.free()
    one.free()
    return bench.difference(seen, reference)


@RULES.add(
    "L8",
    "A process that ran the FMU ends in peace",
    "good practice",
    "release what the library holds once only; look at static destructors and at functions called at exit",
)
def ends_in_peace(bench: Bench) -> Iterator[str]:
    for _ in range(2):
        errand.send([bench.task()], peaceful=True)
    yield from ()
