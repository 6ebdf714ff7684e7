"""Units of measurement written as "kg.m2", "N.m.s/rad", "m/s2", "1/(m.s)", "deg": what they are in SI base units.

expression = product ["/" factor | "/" "(" product ")"];  product = factor {"." factor};  factor = symbol [exponent]
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import pi

BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_TOKEN = re.compile(r"\s*(sqrt\(|[./()]|(?:1|%|[^\W\d_]+)(?:-?\d+)?)")
_SYMBOL = re.compile(r"(1|%|[^\W\d_]+)(-?\d+)?")
_NONE = (Fraction(0),) * len(BASES)


@dataclass(frozen=True, slots=True)
class SiUnit:
    """What a unit is in SI: value in SI = `factor` * value + `offset`; `exponents` are those of BASES."""

    factor: float = 1.0
    offset: float = 0.0
    exponents: tuple[Fraction, ...] = _NONE

    def __mul__(self, other: SiUnit) -> SiUnit:
        exponents = tuple(a + b for a, b in zip(self.exponents, other.exponents, strict=True))
        return SiUnit(self.factor * other.factor, 0.0, exponents)

    def __pow__(self, n: Fraction | int) -> SiUnit:
        if n == 1:
            return self
        return SiUnit(self.factor ** float(n), 0.0, tuple(n * exponent for exponent in self.exponents))


def _base(name: str) -> SiUnit:
    return SiUnit(exponents=tuple(Fraction(base == name) for base in BASES))


def _named() -> dict[str, SiUnit]:
    """Base units first, then each unit from those before it."""
    units = {name: _base(name) for name in BASES} | {"1": SiUnit()}
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
        units[name] = SiUnit(factor * unit.factor, 0.0, unit.exponents)
    return units | {"degC": SiUnit(1.0, 273.15, _base("K").exponents)}


def _expression(text: str, units: dict[str, SiUnit]) -> SiUnit:
    tokens = _TOKEN.findall(text)
    if "".join(tokens) != text or not text:
        raise ValueError(f"unit {text!r} is not written like kg.m2, m/s2 or N/(m.s)")
    try:
        unit = _quotient(tokens, units)
    except (IndexError, KeyError) as error:
        raise ValueError(f"unit {text!r} is not known; known symbols are {', '.join(sorted(units))}") from error
    if tokens:
        raise ValueError(f"unit {text!r}: unexpected {tokens[0]!r}; put a product below the line in brackets")
    return unit


def _quotient(tokens: list[str], units: dict[str, SiUnit]) -> SiUnit:
    unit = _product(tokens, units)
    while tokens[:1] == ["/"]:
        tokens.pop(0)
        unit = unit * _divisor(tokens, units) ** -1
    return unit


def _divisor(tokens: list[str], units: dict[str, SiUnit]) -> SiUnit:
    if tokens[:1] != ["("]:
        return _factor(tokens, units)
    tokens.pop(0)
    return _closed(_product(tokens, units), tokens)


def _product(tokens: list[str], units: dict[str, SiUnit]) -> SiUnit:
    unit = _factor(tokens, units)
    while tokens[:1] == ["."]:
        tokens.pop(0)
        unit = unit * _factor(tokens, units)
    return unit


def _factor(tokens: list[str], units: dict[str, SiUnit]) -> SiUnit:
    token = tokens.pop(0)
    if token == "sqrt(":
        return _closed(_quotient(tokens, units), tokens) ** Fraction(1, 2)
    match = _SYMBOL.fullmatch(token)
    return units[match[1] if match else token] ** int((match and match[2]) or 1)


def _closed(unit: SiUnit, tokens: list[str]) -> SiUnit:
    if tokens.pop(0) != ")":
        raise IndexError
    return unit


_UNITS = _named()


@cache
def parse(text: str) -> SiUnit:
    """The unit `text` means; raises ValueError naming the part that is not known."""
    return _expression(text, _UNITS)
