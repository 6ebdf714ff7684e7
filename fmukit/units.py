"""Units of measurement written as "kg.m2", "N.m.s/rad", "m/s2", "1/(m.s)", "deg": what they are in SI base units.

expression = product ["/" factor | "/" "(" product ")"];  product = factor {"." factor};  factor = symbol [exponent]
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from math import isclose, pi

BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_FACTOR = re.compile(r"(1|%|[^\W\d_]+)(-?\d+)?")
_NONE = (0,) * len(BASES)


@dataclass(frozen=True, slots=True)
class Unit:
    """value in SI = `factor` * value + `offset`; `exponents` are those of BASES."""

    factor: float = 1.0
    offset: float = 0.0
    exponents: tuple[int, ...] = _NONE

    def __mul__(self, other: Unit) -> Unit:
        exponents = tuple(a + b for a, b in zip(self.exponents, other.exponents, strict=True))
        return Unit(self.factor * other.factor, 0.0, exponents)

    def __pow__(self, n: int) -> Unit:
        return self if n == 1 else Unit(self.factor**n, 0.0, tuple(n * exponent for exponent in self.exponents))

    @property
    def dimension(self) -> tuple[int, ...]:
        """Exponents without the radian, which is a pure number."""
        return self.exponents[:-1]


def _base(name: str) -> Unit:
    return Unit(exponents=tuple(int(base == name) for base in BASES))


def _named() -> dict[str, Unit]:
    """Base units first, then each unit from those before it."""
    units = {name: _base(name) for name in BASES} | {"1": Unit()}
    derived = {
        "Hz": (1.0, "1/s"),
        "N": (1.0, "kg.m/s2"),
        "Pa": (1.0, "N/m2"),
        "J": (1.0, "N.m"),
        "W": (1.0, "J/s"),
        "C": (1.0, "A.s"),
        "V": (1.0, "W/A"),
        "T": (1.0, "kg/(A.s2)"),
        "g": (1e-3, "kg"),
        "t": (1e3, "kg"),
        "km": (1e3, "m"),
        "cm": (1e-2, "m"),
        "mm": (1e-3, "m"),
        "ms": (1e-3, "s"),
        "us": (1e-6, "s"),
        "ns": (1e-9, "s"),
        "min": (60.0, "s"),
        "h": (3600.0, "s"),
        "kN": (1e3, "N"),
        "kPa": (1e3, "Pa"),
        "bar": (1e5, "Pa"),
        "kJ": (1e3, "J"),
        "kW": (1e3, "W"),
        "deg": (pi / 180.0, "rad"),
        "rpm": (pi / 30.0, "rad/s"),
        "rev": (2.0 * pi, "rad"),
        "%": (1e-2, "1"),
    }
    for name, (factor, text) in derived.items():
        unit = _expression(text, units)
        units[name] = Unit(factor * unit.factor, 0.0, unit.exponents)
    return units | {"degC": Unit(1.0, 273.15, _base("K").exponents)}


def _expression(text: str, units: dict[str, Unit]) -> Unit:
    numerator, slash, denominator = text.partition("/")
    if not slash:
        return _product(text, numerator, units)
    bracketed = denominator.startswith("(") and denominator.endswith(")")
    if not bracketed and not _FACTOR.fullmatch(denominator):
        raise ValueError(f"unit {text!r}: put the denominator in brackets, as in kg/(m.s)")
    return (
        _product(text, numerator, units) * _product(text, denominator[1:-1] if bracketed else denominator, units) ** -1
    )


def _product(text: str, product: str, units: dict[str, Unit]) -> Unit:
    result: Unit | None = None
    for factor in product.split("."):
        match = _FACTOR.fullmatch(factor)
        if not match or match[1] not in units:
            raise ValueError(f"unit {text!r}: {factor!r} is not known; known are {', '.join(sorted(units))}")
        power = units[match[1]] ** int(match[2] or 1)
        result = power if result is None else result * power
    assert result is not None
    return result


_UNITS = _named()


@cache
def parse(text: str) -> Unit:
    """The unit `text` means; raises ValueError naming the part that is not known."""
    return _expression(text, _UNITS)


def conversion(source: str, target: str) -> tuple[float, float]:
    """(a, b) such that value in `target` = a * value in `source` + b; raises ValueError when they do not match."""
    one, other = parse(source), parse(target)
    if one.dimension != other.dimension:
        raise ValueError(f"a value in {source} cannot be converted to {target}")
    factor = one.factor / other.factor
    return (1.0 if isclose(factor, 1.0, rel_tol=1e-15) else factor), (one.offset - other.offset) / other.factor
