"""FMI 2.0 calls as a C host makes them: every status seen, nothing raised, nothing checked on the way.

Imports ctypes and the XML parser only, so that a process can be watched in which nothing else lives.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from ctypes import byref, c_char, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
_Logger = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
_Allocate = ctypes.CFUNCTYPE(c_void_p, c_size_t, c_size_t)
_Free = ctypes.CFUNCTYPE(None, c_void_p)
_KINDS = {"Real": c_double, "Integer": c_int, "Boolean": c_int, "String": c_char_p}


class _Callbacks(ctypes.Structure):
    _fields_ = (
        ("logger", _Logger),
        ("allocate", _Allocate),
        ("free", _Free),
        ("finished", c_void_p),
        ("environment", c_void_p),
    )


@dataclass(frozen=True)
class Variable:
    """A variable as the XML declares it; `low` and `high` are None where it declares none."""

    name: str
    vr: int
    type: str
    causality: str
    low: float | None
    high: float | None
    start: str | None


@dataclass
class Fmu:
    """An unzipped FMU with its library loaded."""

    folder: Path
    name: str = field(init=False)
    guid: str = field(init=False)
    step: float = field(init=False)
    variables: list[Variable] = field(init=False)

    def __post_init__(self) -> None:
        root = ElementTree.parse(self.folder / "modelDescription.xml").getroot()
        self.guid, self.name = root.attrib["guid"], root.attrib["modelName"]
        experiment = root.find("DefaultExperiment")
        assert experiment is not None
        self.step = float(experiment.attrib["stepSize"])
        self.variables = [_variable(entry) for entry in root.iter("ScalarVariable")]
        libc = ctypes.CDLL(None)
        self.library = ctypes.CDLL(str(self.binary))
        self.library.fmi2Instantiate.restype = c_void_p
        self._allocate = ctypes.cast(libc.calloc, _Allocate)
        self._release = ctypes.cast(libc.free, _Free)

    @property
    def binary(self) -> Path:
        return self.folder / "binaries" / "linux64" / f"{self.name}.so"

    def instantiate(self, name: str = "one") -> Instance:
        return Instance(self, name)


def _variable(entry: ElementTree.Element) -> Variable:
    kind = next(iter(entry))
    low, high = (None if key not in kind.attrib else float(kind.attrib[key]) for key in ("min", "max"))
    about = entry.attrib
    return Variable(
        about["name"], int(about["valueReference"]), kind.tag, about["causality"], low, high, kind.get("start")
    )


class Instance:
    """One instance; every method but `messages` is one call of the standard and returns its status."""

    def __init__(self, fmu: Fmu, name: str) -> None:
        self.messages: list[str] = []
        self._library = fmu.library
        self._callbacks = _Callbacks(_Logger(self._log), fmu._allocate, fmu._release, None, None)
        resources = (fmu.folder / "resources").as_uri().encode()
        handle = self._library.fmi2Instantiate(
            name.encode(), 1, fmu.guid.encode(), resources, byref(self._callbacks), 0, 1
        )
        if not handle:
            raise RuntimeError(f"{fmu.name} cannot be instantiated: {self.messages}")
        self._handle = c_void_p(handle)

    def _log(self, environment: object, name: bytes, status: int, category: bytes, message: bytes) -> None:
        self.messages.append(message.decode("utf-8", "replace"))

    def call(self, function: str, *arguments: object) -> int:
        return getattr(self._library, f"fmi2{function}")(self._handle, *arguments)

    def setup(self, start: float = 0.0) -> int:
        return self.call("SetupExperiment", 0, c_double(0), c_double(start), 0, c_double(0))

    def initialise(self) -> int:
        """The three calls up to the first step; the worst status."""
        return max(self.setup(), self.call("EnterInitializationMode"), self.call("ExitInitializationMode"))

    def set(self, type_: str, vrs: Sequence[int], values: Sequence[object]) -> int:
        count = len(vrs)
        return self.call(f"Set{type_}", (c_uint * count)(*vrs), c_size_t(count), (_KINDS[type_] * count)(*values))

    def get(self, type_: str, vrs: Sequence[int]) -> tuple[int, list[float | int | bytes]]:
        count = len(vrs)
        values = (_KINDS[type_] * count)()
        status = self.call(f"Get{type_}", (c_uint * count)(*vrs), c_size_t(count), values)
        return status, list(values)

    def step(self, time: float, size: float) -> int:
        return self.call("DoStep", c_double(time), c_double(size), 0)

    def get_state(self, state: c_void_p) -> int:
        return self.call("GetFMUstate", byref(state))

    def set_state(self, state: c_void_p) -> int:
        return self.call("SetFMUstate", state)

    def free_state(self, state: c_void_p) -> int:
        return self.call("FreeFMUstate", byref(state))

    def serialise(self, state: c_void_p) -> tuple[int, bytes]:
        size = c_size_t()
        status = self.call("SerializedFMUstateSize", state, byref(size))
        data = (c_char * size.value)()
        return max(status, self.call("SerializeFMUstate", state, data, size)), data.raw

    def deserialise(self, data: bytes, state: c_void_p) -> int:
        return self.call("DeSerializeFMUstate", data, c_size_t(len(data)), byref(state))

    def free(self) -> None:
        self._library.fmi2FreeInstance(self._handle)
