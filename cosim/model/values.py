"""Values of parameters and inputs: converted to the port's type and held against its range."""

from __future__ import annotations

import math

from cosim.errors import CosimError
from cosim.model.face import Port, Value

_BOOLEANS = {"true": True, "1": True, "yes": True, "on": True, "false": False, "0": False, "no": False, "off": False}


def coerce(where: str, port: Port, value: Value) -> Value:
    """`value` as the type of `port`, in its range; `where` names it in the CosimError that is raised otherwise."""
    if port.type == "String":
        return str(value)
    if port.type == "Boolean":
        return _boolean(where, value)
    number = _number(where, value, whole=port.type != "Real")
    low = -math.inf if port.minimum is None else port.minimum
    high = math.inf if port.maximum is None else port.maximum
    if not low <= number <= high:
        unit = f" {port.unit}" if port.unit not in (None, "1") else ""
        raise CosimError(f"{where} = {number:g}{unit} is outside its range {_range(low, high)}{unit}")
    return number


def _boolean(where: str, value: Value) -> bool:
    if isinstance(value, bool):
        return value
    known = _BOOLEANS.get(str(value).lower())
    if known is None:
        raise CosimError(f"{where} = {value} is not a Boolean; write true or false")
    return known


def _number(where: str, value: Value, *, whole: bool) -> float | int:
    try:
        number = int(value) if whole and math.isfinite(float(value)) else float(value)
    except ValueError:
        raise CosimError(f"{where} = {value} is not {'a whole number' if whole else 'a number'}") from None
    except OverflowError:  # a whole number beyond all doubles
        number = math.inf
    if not math.isfinite(number) or (whole and float(value) != number):
        raise CosimError(f"{where} = {value} is not {'a whole' if whole else 'a finite'} number")
    return number


def _range(low: float, high: float) -> str:
    if math.isinf(high):
        return f"of at least {low:g}"
    if math.isinf(low):
        return f"of at most {high:g}"
    return f"{low:g} ... {high:g}"
