"""A Python module in place of the compiled kernel: loaded with the first instance, let go with the last.

What the module must define, and what becomes of its errors, is told in `fmukit/python_kernel.py`.
"""

from __future__ import annotations

import re
import sys
import threading
import weakref
from array import array
from collections.abc import Mapping, Sequence
from importlib import import_module
from math import isfinite
from pathlib import Path
from typing import Any

from .description import Description, Scalar, ScriptProgram
from .shared import Shared

SAID = -3
_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
_LONGEST = 300
# Solvers give up Python's global lock while they work. The interpreter is what all FMUs of a process share.
_turn: threading.RLock = sys.__dict__.setdefault("_fmukit_turn", threading.RLock())
_loaded = Shared(_turn, lambda _: None)


class ScriptError(Exception):
    """The module cannot be used; the message is a sentence for the user."""


def _load(program: ScriptProgram, folder: Path, user: object) -> tuple[Any, Any]:
    """The module of the FMU whose package lies in `folder`, and what it prepared, for one more user.

    With the end of the last user the compiled libraries are let go, so that their files can be deleted.
    """
    found: tuple[Any, Any] = _loaded.take(str(folder), lambda: _prepared(program, folder))
    weakref.finalize(user, _loaded.give_back, str(folder)).atexit = False
    return found


def _prepared(program: ScriptProgram, folder: Path) -> tuple[Any, Any]:
    """All modules are imported at once: the folder may be gone when one is needed."""
    for package, least in program.packages:
        _require(package, least)
    root = __name__.rpartition(".runtime.")[0]
    modules = [import_module(f"{root}.{name}") for name in program.modules]
    libraries = {name: folder / f"{name}{_SUFFIX}" for name in program.libraries}
    for path in libraries.values():
        if not path.is_file():
            raise ScriptError(f"this FMU has no {path.name} for {sys.platform}; build it for this platform")
    return modules[0], modules[0].prepare({name: str(path) for name, path in libraries.items()})


def _require(package: str, least: str) -> None:
    """Raise ScriptError unless this interpreter has the package in this version or a newer one."""
    where = f"the Python {'.'.join(map(str, sys.version_info[:3]))} in {sys.prefix}"
    python = sys.executable if "python" in Path(sys.executable or "").name else "python3"
    remedy = f'run: {python} -m pip install "{package}>={least}"'
    try:
        found = str(import_module(package).__version__)
    except ModuleNotFoundError as error:
        what = f"{where} does not have" if error.name == package else f"{where} cannot import ({error})"
        raise ScriptError(
            f"this FMU needs the Python package {package} {least} or newer, which {what}; {remedy}"
        ) from error
    except Exception as error:  # extension modules raise many kinds when they cannot be loaded
        raise ScriptError(
            f"this FMU needs the Python package {package}, which {where} cannot import ({brief(error)}); {remedy}"
        ) from error
    if _numbers(found) < _numbers(least):
        raise ScriptError(
            f"this FMU needs the Python package {package} {least} or newer, but {where} has {found}; {remedy}"
        )


def _numbers(version: str) -> list[int]:
    return [int(number) for number in re.findall(r"\d+", version)[:3]]


def brief(error: BaseException) -> str:
    """What an exception says, on one line of sane length."""
    text = " ".join(str(error).split()) or type(error).__name__
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]} ..."


class Script:
    """One instance's module: reads and writes its buffer, as the compiled kernel does.

    Both calls return 0, or the slot of a result that is not finite plus one, or SAID: `said` has the reason. Whatever
    goes wrong, the buffer stays as it was.
    """

    def __init__(self, about: Description, buffer: array[float], strings: Mapping[int, str], folder: Path) -> None:
        assert about.program is not None
        self._module, self._tools = _load(about.program, folder, self)
        self._buffer, self._strings = buffer, strings
        self._parameters = _slots(about, "parameter")
        self._inputs = _slots(about, "input")
        self._outputs = [scalar.name for slot, scalar in _slots(about, "output") if slot != about.fault]
        self._names = frozenset(self._outputs)
        self._y = slice(about.fault - len(self._outputs), about.fault)
        self._d = slice(len(about.scalars), len(about.scalars) + about.program.derived)
        self._x = slice(self._d.stop, about.size)
        self._columns = len(about.table.columns) if about.table else 0
        self.said = ""

    def initialise(self, flat: Sequence[float], rows: int) -> int:
        """As `fmukit_initialise`: the table as its cells row by row, of which the first `rows` rows count."""
        try:
            table = [list(flat[k * self._columns : (k + 1) * self._columns]) for k in range(rows)]
            with _turn:
                d, x, y = self._module.initialise(self._tools, self._p(), self._u(), table)
            return self._take(y, x, d)
        except BaseException as error:
            return self._say(error)

    def sample(self, _address: int, _seed: int, _index: int, t: float) -> int:
        """As `fmukit_sample`, of which it needs the time only."""
        try:
            d, x = self._buffer[self._d], self._buffer[self._x]
            with _turn:
                x_next, y = self._module.sample(self._tools, self._p(), d, self._u(), x, t)
            return self._take(y, x_next)
        except BaseException as error:
            return self._say(error)

    def _say(self, error: BaseException) -> int:
        kind = "" if isinstance(error, ValueError) else f"unexpected {type(error).__name__}: "
        self.said = kind + brief(error)
        return SAID

    def _p(self) -> dict[str, float | bool | int | str]:
        return {scalar.name: self._value(slot, scalar) for slot, scalar in self._parameters}

    def _u(self) -> dict[str, float]:
        return {scalar.name: self._buffer[slot] for slot, scalar in self._inputs}

    def _value(self, slot: int, scalar: Scalar) -> float | bool | int | str:
        if scalar.type == "Real":
            return self._buffer[slot]
        if scalar.type == "String":
            return self._strings[slot]
        return self._buffer[slot] != 0.0 if scalar.type == "Boolean" else int(self._buffer[slot])

    def _take(self, y: Mapping[str, float], x: Sequence[float], d: Sequence[float] | None = None) -> int:
        """Take the results over into the buffer when all are there and finite."""
        if y.keys() != self._names:
            raise LookupError(f"outputs missing or unknown: {', '.join(sorted(y.keys() ^ self._names))}")
        results = [(self._y, [y[name] for name in self._outputs]), (self._x, x)]
        results += [] if d is None else [(self._d, d)]
        taken = [(where, array("d", values)) for where, values in results]
        for where, values in taken:
            if len(values) != where.stop - where.start:
                raise LookupError(f"{len(values)} values in place of {where.stop - where.start}")
            if not all(map(isfinite, values)):
                return 1 + where.start + list(map(isfinite, values)).index(False)
        for where, values in taken:
            self._buffer[where] = values
        return 0


def _slots(about: Description, causality: str) -> list[tuple[int, Scalar]]:
    return [(slot, scalar) for slot, scalar in enumerate(about.scalars) if scalar.causality == causality]
