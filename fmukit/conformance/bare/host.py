"""A host with nothing but the standard library: raw FMI 2.0 calls that return their status instead of raising."""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable, Sequence
from ctypes import byref, c_char, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from dataclasses import dataclass
from typing import Any

OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
STATUS = ("ok", "warning", "discard", "error", "fatal", "pending")
TYPES: dict[str, Any] = {"Real": c_double, "Integer": c_int, "Boolean": c_int, "String": c_char_p}
Row = tuple[Any, ...]

_LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
_ALLOCATE = ctypes.CFUNCTYPE(c_void_p, c_size_t, c_size_t)
_FREE = ctypes.CFUNCTYPE(None, c_void_p)
_FINISHED = ctypes.CFUNCTYPE(None, c_void_p, c_int)
_MOST_MESSAGES, _LONGEST_MESSAGE = 100_000, 2_000
_libraries: dict[str, ctypes.CDLL] = {}
ears: list[Callable[[str], None]] = []
"""Who is told of every call before it is made, and ("") when it has returned."""


class CallFailed(Exception):  # noqa: N818  (what happened, said of the FMU)
    """A call that had to succeed did not; the message is a sentence."""


class Callbacks(ctypes.Structure):
    """fmi2CallbackFunctions."""

    _fields_ = [
        ("logger", _LOGGER),
        ("allocate", _ALLOCATE),
        ("free", _FREE),
        ("finished", _FINISHED),
        ("environment", c_void_p),
    ]


@dataclass(frozen=True)
class Target:
    """Which FMU to run and which of its variables to touch: value references of the Real inputs and of all outputs."""

    library: str
    resources: str
    guid: str
    inputs: tuple[int, ...]
    outputs: tuple[tuple[str, tuple[int, ...]], ...]


@dataclass(frozen=True)
class Experiment:
    """A run: communication steps of `step` [s] from time `start` [s], with one row of input values held over each."""

    start: float
    step: float
    rows: tuple[tuple[float, ...], ...]

    def until(self, count: int) -> Experiment:
        """The first `count` steps."""
        return Experiment(self.start, self.step, self.rows[:count])


class RawInstance:
    """One instance. The library stays loaded until the process ends, so static data outlives instances."""

    def __init__(
        self, target: Target, name: str = "instance", prepare: Callable[[Callbacks], None] | None = None
    ) -> None:
        self.target, self.messages = target, list[tuple[int, str]]()
        if target.library not in _libraries:
            _tell("the loading of the library")
            _libraries[target.library] = _load(target.library)
        self._library = _libraries[target.library]
        self._callbacks = Callbacks(_LOGGER(self._log), _memory("calloc", _ALLOCATE), _memory("free", _FREE))
        if prepare:
            prepare(self._callbacks)
        texts = (name.encode(), target.guid.encode(), target.resources.encode())
        arguments = (texts[0], c_int(1), texts[1], texts[2], byref(self._callbacks), c_int(0), c_int(1))
        self.component = c_void_p(self._ask("Instantiate", c_void_p, *arguments))

    def _log(self, _environment: Any, _name: bytes, status: int, _category: bytes, message: bytes) -> None:
        if len(self.messages) < _MOST_MESSAGES:
            text = (message or b"")[:_LONGEST_MESSAGE].decode("utf-8", "replace")
            self.messages.append((status, " ".join(text.split())))

    def _ask(self, name: str, result: Any, *arguments: Any) -> Any:
        try:
            function = self._library[f"fmi2{name}"]  # indexing gives a new object with types of its own
        except AttributeError:
            raise CallFailed(f"the library does not export fmi2{name}") from None
        function.restype = result
        _tell(f"fmi2{name}")
        answer = function(*arguments)
        _tell("")
        return answer

    def call(self, name: str, *arguments: Any) -> int:
        """The status of `fmi2<name>(component, *arguments)`; arguments are ctypes values."""
        return int(self._ask(name, c_int, self.component, *arguments))

    def must(self, name: str, *arguments: Any) -> None:
        """`call` that raises CallFailed unless the answer is ok or warning."""
        self.expect(f"fmi2{name}", self.call(name, *arguments))

    def expect(self, what: str, status: int) -> None:
        """Raise CallFailed, naming `what` was called, unless `status` is ok or warning."""
        if status > WARNING:
            raise CallFailed(f"{what} answers {word(status)}{self.last()}")

    def last(self) -> str:
        """The last message in brackets, or nothing."""
        return f" ({self.messages[-1][1]})" if self.messages else ""

    # life cycle

    def setup(self, start: float) -> int:
        """Call fmi2SetupExperiment with the time [s] at which the run starts, without an end."""
        return self.call("SetupExperiment", c_int(0), c_double(0), c_double(start), c_int(0), c_double(0))

    def enter(self, start: float) -> None:
        """From instantiated to initialisation mode."""
        self.expect("fmi2SetupExperiment", self.setup(start))
        self.must("EnterInitializationMode")

    def step(self, time: float, size: float) -> int:
        """Take a step from `time` over `size` [s]; gives the status."""
        return self.call("DoStep", c_double(time), c_double(size), c_int(1))

    def free(self) -> None:
        """Free the instance, which must not be called any more."""
        self._ask("FreeInstance", None, self.component)

    # variables

    def get(self, type_: str, references: Sequence[int]) -> tuple[int, list[Any]]:
        """The status and the values of variables of a type, by value references."""
        values = (TYPES[type_] * len(references))()
        status = self.call(f"Get{type_}", (c_uint * len(references))(*references), c_size_t(len(references)), values)
        return status, list(values)

    def set(self, type_: str, references: Sequence[int], values: Sequence[Any]) -> int:
        """Set variables of a type, by value references; gives the status."""
        count = len(references)
        given = [value.encode() if isinstance(value, str) else value for value in values]
        return self.call(f"Set{type_}", (c_uint * count)(*references), c_size_t(count), (TYPES[type_] * count)(*given))

    def outputs(self) -> Row:
        """All outputs in the order of the target."""
        row: list[Any] = []
        for type_, references in self.target.outputs:
            status, values = self.get(type_, references)
            self.expect(f"fmi2Get{type_} of the outputs", status)
            row += values
        return tuple(row)

    def feed(self, values: Sequence[float]) -> None:
        """Set the Real inputs of the target; raises CallFailed."""
        if values:
            self.expect("fmi2SetReal of the inputs", self.set("Real", self.target.inputs, values))

    # FMU states

    def state(self) -> c_void_p:
        """A new FMU state, which `forget` must free; raises CallFailed."""
        state = c_void_p()
        self.must("GetFMUstate", byref(state))
        return state

    def restore(self, state: c_void_p) -> None:
        """Go back to an FMU state; raises CallFailed."""
        self.must("SetFMUstate", state)

    def forget(self, state: c_void_p) -> None:
        """Free an FMU state; raises CallFailed."""
        self.must("FreeFMUstate", byref(state))

    def to_bytes(self, state: c_void_p) -> bytes:
        """An FMU state serialised; raises CallFailed."""
        size = c_size_t()
        self.must("SerializedFMUstateSize", state, byref(size))
        data = (c_char * size.value)()
        self.must("SerializeFMUstate", state, data, size)
        return bytes(data.raw)

    def from_bytes(self, data: bytes) -> tuple[int, c_void_p]:
        """The status of deserialising bytes, and the FMU state made of them."""
        state, memory = c_void_p(), ctypes.create_string_buffer(data, max(1, len(data)))
        return self.call("DeSerializeFMUstate", memory, c_size_t(len(data)), byref(state)), state


def steps(instance: RawInstance, experiment: Experiment, first: int = 0, forgiving: bool = False) -> list[Row]:
    """The outputs after each step of the experiment from number `first` on; `forgiving` repeats one discarded step."""
    seen: list[Row] = []
    for k in range(first, len(experiment.rows)):
        time = experiment.start + k * experiment.step
        instance.feed(experiment.rows[k])
        status = instance.step(time, experiment.step)
        if status == DISCARD and forgiving:
            instance.feed(experiment.rows[k])
            status, forgiving = instance.step(time, experiment.step), False
        instance.expect(f"fmi2DoStep at {time:g} s", status)
        seen.append(instance.outputs())
    return seen


def initialised(instance: RawInstance, experiment: Experiment) -> Row:
    """From instantiated to stepping; the outputs at the start."""
    instance.enter(experiment.start)
    instance.must("ExitInitializationMode")
    return instance.outputs()


def life(instance: RawInstance, experiment: Experiment) -> list[Row]:
    """The whole life of a new instance: the outputs at the start and after each step."""
    seen = [initialised(instance, experiment), *steps(instance, experiment)]
    instance.must("Terminate")
    instance.free()
    return seen


def made(target: Target, name: str = "instance", prepare: Callable[[Callbacks], None] | None = None) -> RawInstance:
    """A new instance; raises CallFailed if the FMU makes none."""
    instance = RawInstance(target, name, prepare)
    if not instance.component:
        raise CallFailed(f"fmi2Instantiate returns no instance{instance.last()}")
    return instance


def word(status: int) -> str:
    """The name of a status."""
    return STATUS[status] if 0 <= status < len(STATUS) else f"the unknown status {status}"


def _tell(call: str) -> None:
    for ear in ears:
        ear(call)


def _load(path: str) -> ctypes.CDLL:
    try:
        return ctypes.CDLL(path, winmode=0x8) if sys.platform == "win32" else ctypes.CDLL(path)
    except OSError as error:
        raise CallFailed(f"the library cannot be loaded: {error}") from None


def _memory(name: str, prototype: Any) -> Any:
    library = ctypes.cdll.msvcrt if sys.platform == "win32" else ctypes.CDLL(None)
    return ctypes.cast(getattr(library, name), prototype)
