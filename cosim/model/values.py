"""Values of parameters and inputs: converted to the port's type and held against its range."""

from __future__ import annotations

import math
from decimal import Decimal, InvalidOperation

from cosim.errors import CosimError
from cosim.model.face import Port, Value

INTEGERS = (-(2**31), 2**31 - 1)  # fmi2Integer; beyond, a value would be wrapped on its way into the FMU
_MOST_DIGITS = 20
_BOOLEANS = {"true": True, "1": True, "yes": True, "on": True, "false": False, "0": False, "no": False, "off": False}


def coerce(where: str, port: Port, value: Value) -> Value:
    """`value` as the type of `port`, in its range; `where` names it in the CosimError that is raised otherwise."""
    if port.type == "String":
        return str(value)
    if port.type == "Boolean":
        return _boolean(where, value)
    if port.items:
        return _item(where, port, value)
    whole = port.type != "Real"
    number = _whole(where, value) if whole else _real(where, value)
    lowest, highest = INTEGERS if whole else (-math.inf, math.inf)
    low = lowest if port.minimum is None else port.minimum
    high = highest if port.maximum is None else port.maximum
    if not low <= number <= high:
        unit = f" {port.unit}" if port.unit not in (None, "1") else ""
        raise CosimError(f"{where} = {_shown(number)}{unit} is outside its range {_range(low, high)}{unit}")
    return number


def _item(where: str, port: Port, value: Value) -> int:
    """The value of an Enumeration's item, given by the item's name or value."""
    known = dict(port.items) | {str(number): number for _, number in port.items}
    if str(value) not in known:
        raise CosimError(f"{where} = {value} is none of {', '.join(f'{name} ({n})' for name, n in port.items)}")
    return known[str(value)]


def _boolean(where: str, value: Value) -> bool:
    if isinstance(value, bool):
        return value
    if isinstance(value, float) and value in (0.0, 1.0):
        return bool(value)
    known = _BOOLEANS.get(str(value).lower())
    if known is None:
        raise CosimError(f"{where} = {value} is not a Boolean; write true or false")
    return known


def _whole(where: str, value: Value) -> int:
    """A whole number, also one written as 3.0 or 1e2."""
    try:
        number = Decimal(str(value))
        whole = number.is_finite() and number == number.to_integral_value()
    except InvalidOperation:
        whole = False
    if not whole:
        raise CosimError(f"{where} = {value} is not a whole number")
    if number.adjusted() > _MOST_DIGITS:
        raise CosimError(f"{where} = {value} is too large for any Integer")
    return int(number)


def _real(where: str, value: Value) -> float:
    try:
        number = float(value)
    except ValueError:
        raise CosimError(f"{where} = {value} is not a number") from None
    except OverflowError:  # a whole number beyond all doubles
        number = math.inf
    if not math.isfinite(number):
        raise CosimError(f"{where} = {value} is not a finite number")
    return number


def _range(low: float, high: float) -> str:
    if math.isinf(high):
        return f"of at least {_shown(low)}"
    if math.isinf(low):
        return f"of at most {_shown(high)}"
    return f"{_shown(low)} ... {_shown(high)}"


def _shown(number: float) -> str:
    """As short as it can be without becoming another number."""
    short = f"{number:g}"
    return short if float(short) == number else str(number).removesuffix(".0")
