"""What becomes of a value on its way from an output to an input: linear steps, and lookups of whole numbers."""

from __future__ import annotations

from dataclasses import dataclass

from cosim.model.units import Conversion


@dataclass(frozen=True, slots=True)
class Lookup:
    """Every value that may come, and what it becomes: of Booleans (0 and 1), Integers and Enumerations.

    `partial`: values without an entry stay as they are.
    """

    entries: tuple[tuple[int, int], ...]
    partial: bool = False

    def __call__(self, value: float) -> float:
        """What `value` becomes; raises LookupError where no entry says."""
        for source, target in self.entries:
            if source == value:
                return float(target)
        if self.partial:
            return value
        raise LookupError


@dataclass(frozen=True, slots=True)
class Transformation:
    """Steps that follow one another; none leave the value as it is."""

    steps: tuple[Conversion | Lookup, ...] = ()

    def __call__(self, value: float) -> float:
        """What `value` becomes; raises LookupError where a lookup has no entry for it."""
        for step in self.steps:
            value = step(value)
        return value

    @property
    def linear(self) -> Conversion | None:
        """All steps in one; None where there are lookups."""
        if not self.steps:
            return Conversion()
        only = self.steps[0] if len(self.steps) == 1 else None
        return only if isinstance(only, Conversion) else None

    def then(self, step: Conversion | Lookup) -> Transformation:
        """This and one step more; linear steps in a row become one."""
        if isinstance(step, Conversion):
            if step.trivial:
                return self
            if self.steps and isinstance(self.steps[-1], Conversion):
                return Transformation((*self.steps[:-1], self.steps[-1].then(step)))
        return Transformation((*self.steps, step))


AS_IT_IS = Transformation()
"""Nothing happens to the value."""
