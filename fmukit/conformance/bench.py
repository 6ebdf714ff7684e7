"""The test bench of one FMU: where it is unpacked, what it declares, a run that excites it, and instances of it."""

from __future__ import annotations

import random
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from ctypes import byref
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

from fmukit.conformance import errand
from fmukit.conformance.bare import host
from fmukit.conformance.package import Package
from fmukit.conformance.rule import NotApplicable
from fmukit.conformance.trying import near
from fmukit.conformance.variable import ScalarVariable

T = TypeVar("T")
_PLATFORMS = {"win32": ("win64", ".dll"), "darwin": ("darwin64", ".dylib")}
PLATFORM = _PLATFORMS.get(sys.platform, ("linux64", ".so"))
STATES = ("instantiated", "initialisation", "stepping", "terminated")
STEPS = 40
RESETS = "resets"
"""What `Bench.after_resets` is remembered under."""
_DEFAULT_STEP = 1e-2


@dataclass(frozen=True)
class Bench:
    """One FMU, unpacked in `folder`; `others` are unpacked FMUs to run beside it.

    `memory` holds what `remember` worked out.
    """

    package: Package
    folder: Path
    others: tuple[Bench, ...] = ()
    memory: dict[str, Any] = field(default_factory=dict, compare=False)

    # what it declares

    @cached_property
    def target(self) -> host.Target:
        """The FMU as the raw host needs it."""
        place, suffix = PLATFORM
        library = self.folder / "binaries" / place / f"{self.package.identifier}{suffix}"
        outputs = [(t, tuple(v.vr for v in self.select("output", t))) for t in ("Real", "Integer", "Boolean")]
        return host.Target(
            library=str(library),
            resources=(self.folder / "resources").resolve().as_uri(),
            guid=self.package.guid,
            inputs=tuple(v.vr for v in self.select("input", "Real")),
            outputs=tuple(pair for pair in outputs if pair[1]),
        )

    def select(self, causality: str, *types: str) -> tuple[ScalarVariable, ...]:
        """The variables of a causality and of the types (default: all); an Enumeration counts as Integer."""
        return tuple(
            v for v in self.package.variables if v.causality == causality and (not types or v.fmi_type in types)
        )

    @cached_property
    def outputs(self) -> tuple[ScalarVariable, ...]:
        """In the order of the rows of a run."""
        return tuple(v for type_ in ("Real", "Integer", "Boolean") for v in self.select("output", type_))

    @property
    def continuous(self) -> bool:
        """Whether it has continuous outputs; the standard's own variability tells."""
        return any(v.variability == "continuous" for v in self.select("output", "Real"))

    def requires(self, flag: str, why: str) -> None:
        """Raise NotApplicable, saying `why`, when the FMU does not declare the capability `flag`."""
        if not self.package.flag(flag):
            raise NotApplicable(f"{why} ({flag} is not declared)")

    # the run that excites it

    @cached_property
    def experiment(self) -> host.Experiment:
        """Inputs near their start values, inside their limits, new at each step; the same whenever asked for."""
        generator = random.Random(self.package.identifier)
        inputs = self.select("input", "Real")
        rows = tuple(tuple(near(v, generator) for v in inputs) for _ in range(STEPS))
        declared = self.package.root.find("DefaultExperiment")
        start = 0.0 if declared is None else float(declared.get("startTime", 0.0))
        return host.Experiment(start, self.package.step or _DEFAULT_STEP, rows)

    def reference(self) -> list[host.Row]:
        """The outputs of the experiment: at the start and after each step. Not applicable when they do not repeat."""
        one, other = self.remember("two runs", lambda: [self.life(self.experiment) for _ in range(2)])
        if repr(one) != repr(other):
            raise NotApplicable("two runs of this FMU differ (see the rules on determinism and on repeated lives)")
        return one

    def alone(self) -> list[host.Row]:
        """The outputs of the experiment in a process of its own; not applicable when they differ from run to run."""
        one, other = self.runs_alone()
        if repr(one) != repr(other):
            raise NotApplicable("two runs of this FMU differ (see the rule on determinism)")
        return one

    def runs_alone(self) -> list[list[host.Row]]:
        """The outputs of the experiment in two processes of their own."""
        return self.remember("two runs alone", lambda: [errand.send([self.task()])[0][0] for _ in range(2)])

    def task(self) -> errand.Task:
        """The experiment as an errand."""
        return errand.lives([(self.target, self.experiment)])

    # what was found out before

    def remember(self, name: str, find: Callable[[], T]) -> T:
        """`find()`, worked out once under this name; what it raises is not remembered."""
        if name not in self.memory:
            self.memory[name] = find()
        value: T = self.memory[name]
        return value

    def known(self, name: str, otherwise: T) -> T:
        """What was remembered under the name, `otherwise` if nothing was."""
        value: T = self.memory.get(name, otherwise)
        return value

    # instances

    def make(self, name: str = "instance") -> host.RawInstance:
        """A new instance; raises CallFailed if the FMU makes none."""
        return host.made(self.target, name, None if self.package.python else formatting)

    def life(self, experiment: host.Experiment) -> list[host.Row]:
        """The outputs of a whole life: at the start and after each step."""
        return host.life(self.make(), experiment)

    def lead(self, state: str, count: int = 5) -> host.RawInstance:
        """A new instance led to one of STATES; stepping and terminated come after `count` steps."""
        instance = self.make()
        if state == "instantiated":
            return instance
        instance.enter(self.experiment.start)
        if state == "initialisation":
            return instance
        instance.must("ExitInitializationMode")
        host.steps(instance, self.experiment.until(count))
        if state == "terminated":
            instance.must("Terminate")
        return instance

    def finish(self, instance: host.RawInstance, state: str, count: int = 5) -> list[host.Row]:
        """The outputs after each of the remaining steps; one discarded step is forgiven, see `disturbance`."""
        if state == "terminated":
            instance.must("Reset")
        if state in ("instantiated", "terminated"):
            instance.enter(self.experiment.start)
        if state != "stepping":
            instance.must("ExitInitializationMode")
        return host.steps(instance, self.experiment, count if state == "stepping" else 0, forgiving=True)

    def dismiss(self, instance: host.RawInstance, state: str) -> None:
        """Free an instance, after its initialisation (freeing it earlier is the matter of a rule of its own)."""
        if state == "initialisation":
            instance.call("ExitInitializationMode")
        instance.free()

    def after_resets(self) -> dict[str, str]:
        """What a reset in each state leaves behind, if anything."""
        return self.remember(RESETS, lambda: {state: self._after_reset(state) for state in STATES})

    def _after_reset(self, state: str) -> str:
        instance = self.lead(state)
        instance.must("Reset")
        seen = [host.initialised(instance, self.experiment), *host.steps(instance, self.experiment)]
        instance.free()
        return self.difference(seen, self.reference())

    def difference(self, seen: Sequence[host.Row], expected: Sequence[host.Row]) -> str:
        """Where two runs, which end together, first differ: 'at 0.25 s y is 3.0 instead of 2.0', or nothing."""
        start, step, count = self.experiment.start, self.experiment.step, len(self.experiment.rows)
        for k, (row, other) in enumerate(zip(seen, expected, strict=True)):
            for v, value, right in zip(self.outputs, row, other, strict=True):
                if repr(value) != repr(right):
                    time = start + (count - len(seen) + k + 1) * step
                    return f"at {time:g} s {v.name} is {value!r} instead of {right!r}"
        return ""


def formatting(callbacks: host.Callbacks) -> None:
    """Have messages formatted by C's printf before they are logged, as hosts written in C do, where FMPy can."""
    with suppress(Exception):
        from fmpy.logging import addLoggerProxy  # noqa: PLC0415  (a native library not every platform has)

        addLoggerProxy(byref(callbacks))
