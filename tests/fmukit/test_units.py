"""Units in their text form."""

from __future__ import annotations

import math

import pytest

from fmukit.units import BASES, SiUnit, parse


def _exponents(**powers: float) -> tuple[float, ...]:
    return tuple(powers.get(base, 0) for base in BASES)


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("1", SiUnit()),
        ("m", SiUnit(exponents=_exponents(m=1))),
        ("kg.m2", SiUnit(exponents=_exponents(kg=1, m=2))),
        ("m/s2", SiUnit(exponents=_exponents(m=1, s=-2))),
        ("1/s", SiUnit(exponents=_exponents(s=-1))),
        ("N.m.s/rad", SiUnit(exponents=_exponents(kg=1, m=2, s=-1, rad=-1))),
        ("kg/(m.s)", SiUnit(exponents=_exponents(kg=1, m=-1, s=-1))),
        ("km/h", SiUnit(1000.0 / 3600.0, exponents=_exponents(m=1, s=-1))),
        ("deg", SiUnit(math.pi / 180.0, exponents=_exponents(rad=1))),
        ("degC", SiUnit(1.0, 273.15, _exponents(K=1))),
        ("%", SiUnit(0.01)),
        ("m/s2/sqrt(Hz)", SiUnit(exponents=_exponents(m=1, s=-1.5))),
        ("deg/sqrt(h)", SiUnit(math.pi / 180.0 / 60.0, exponents=_exponents(rad=1, s=-0.5))),
        ("sqrt(m2/s2)", SiUnit(exponents=_exponents(m=1, s=-1))),
        ("m2/s3", SiUnit(exponents=_exponents(m=2, s=-3))),
    ],
)
def test_parse(text: str, unit: SiUnit) -> None:
    parsed = parse(text)
    assert parsed.factor == pytest.approx(unit.factor, rel=1e-15)
    assert (parsed.offset, parsed.exponents) == (unit.offset, unit.exponents)


@pytest.mark.parametrize(
    "text", ["", "furlong", "m//s", "kg/m.s", "m s", "m^2", "/s", "N.m/(s", ".", "sqrt(m", "m)", "sqrtm", "m..s"]
)
def test_unknown_units_are_named(text: str) -> None:
    with pytest.raises(ValueError, match="unit"):
        parse(text)
