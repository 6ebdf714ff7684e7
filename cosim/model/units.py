"""Units as FMI 2.0 defines them: SI value = factor * value + offset, with integer exponents of the base units."""

from __future__ import annotations

from dataclasses import dataclass

from cosim.errors import CosimError

BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True, slots=True)
class Unit:
    """One entry of UnitDefinitions; `exponents` in the order of BASE, None when the FMU gives no base unit.

    `relative` is a difference of two values in that unit, to which no offset applies (FMI 2.0.4, 2.2.2).
    """

    name: str
    exponents: tuple[int, ...] | None = None
    factor: float = 1.0
    offset: float = 0.0
    relative: bool = False


@dataclass(frozen=True, slots=True)
class Conversion:
    """target value = factor * source value + offset."""

    factor: float = 1.0
    offset: float = 0.0

    @property
    def trivial(self) -> bool:
        return self.factor == 1.0 and self.offset == 0.0

    def __call__(self, value: float) -> float:
        """The converted value."""
        return self.factor * value + self.offset

    def then(self, other: Conversion) -> Conversion:
        """This conversion and after it the other, in one."""
        return Conversion(self.factor * other.factor, self.offset * other.factor + other.offset)


def conversion(source: Unit | None, target: Unit | None, where: str) -> Conversion:
    """How to convert `source` into `target`; without a unit on either side the value passes unchanged.

    Raises CosimError naming `where` (the connection) when the units do not measure the same quantity.
    """
    if source is None or target is None or (source == target):
        return Conversion()
    if source.exponents is None or target.exponents is None:
        if source.name == target.name:
            return Conversion()
        raise CosimError(f"{where}: cannot relate the units {source.name} and {target.name}, as one has no base unit")
    if source.exponents != target.exponents:
        raise CosimError(f"{where}: the units {source.name} and {target.name} do not measure the same quantity")
    if source.relative != target.relative and (source.offset or target.offset):
        kinds = [f"a {'difference' if unit.relative else 'value'} in {unit.name}" for unit in (source, target)]
        raise CosimError(
            f"{where}: {kinds[0]} cannot become {kinds[1]}; relativeQuantity must be the same on both sides"
        )
    if source.relative:
        return Conversion(source.factor / target.factor)
    return Conversion(source.factor / target.factor, (source.offset - target.offset) / target.factor)
