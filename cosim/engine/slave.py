"""What the master needs of a slave; FMUs implement it in `cosim.engine.fmu`, tests with slaves of lambdas."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from ctypes import c_double
from typing import NamedTuple, Protocol

from cosim.model.face import Face, Value
from cosim.model.signals import Vector

Call = Callable[[], int]

OK, WARNING, DISCARD, ERROR = 0, 1, 2, 3
CRASH, HANG = 6, 7
"""Beyond the statuses of FMI: the process of an isolated instance has ended, or did not answer in time."""
STATUS = {2: "discard", 3: "error", 4: "fatal error", 5: "pending", CRASH: "crash", HANG: "no answer"}


def do_nothing() -> int:
    """The call of a slave that has nothing to take or to give, and the action of one that has nothing to show."""
    return OK


class Calls(NamedTuple):
    """The hot loop's three calls; each returns an fmi2Status, and above WARNING the run stops."""

    set: Call
    step: Call
    get: Call


class Memory(NamedTuple):
    """What the calls work on: `u` holds the values of `inputs`, `y` receives `outputs`, `step` advances `time` [s].

    Both are in order of their types, Real ones first. `z` receives the String outputs `texts`, and `w` holds the values
    of the String inputs `written`.
    """

    time: c_double
    step: c_double
    inputs: Sequence[str]
    u: Vector
    outputs: Sequence[str]
    y: Vector
    texts: Sequence[str] = ()
    z: list[str] = []  # noqa: RUF012 - never changed, since there are no names
    written: Sequence[str] = ()
    w: list[str] = []  # noqa: RUF012


class SlaveError(Exception):
    """A slave refused or failed: `instance`, the fmi2 `status`, and the slave's own last sentence if it gave one.

    `ended`: it discarded a step because its simulation is over, which is no failure.
    """

    def __init__(self, instance: str, status: int, message: str, *, ended: bool = False) -> None:
        super().__init__(message)
        self.ended = ended
        self.instance = instance
        self.status = status
        self.message = message

    def sentence(self, when: str) -> str:
        """E.g. "plant failed at 1.25 s (discard): the input wheel_torque.fl is not finite"."""
        reason = self.message.rstrip(". ") or "the FMU gave no reason"
        return f"{self.instance} failed {when} ({STATUS.get(self.status, f'status {self.status}')}): {reason}"


class Slave(Protocol):
    """Call order: set, enter, bind, (calls.set, calls.get)*, leave, (set, calls.set, calls.step, calls.get)*, close."""

    face: Face

    def set(self, values: Mapping[str, Value]) -> None:
        """Set parameters and start values of inputs, between steps inputs that are not connected; raises SlaveError."""

    def enter(self) -> None:
        """Set up the experiment at time 0 and enter initialisation mode; raises SlaveError."""

    def bind(self, memory: Memory) -> Calls:
        """The calls of the hot loop, on fixed memory."""

    def leave(self) -> None:
        """Exit initialisation mode; raises SlaveError."""

    def failed(self, status: int) -> None:
        """Be told that a call of the hot loop came back with `status`: what may still be called depends on it."""

    def ended(self) -> bool:
        """Whether the step just discarded was discarded because the slave wants the simulation to end."""

    def message(self) -> str:
        """The slave's last logged sentence about something wrong, or an empty string."""

    def close(self) -> None:
        """Free the slave; never raises."""


class Restorable(Slave, Protocol):
    """A slave whose state can be taken and put back, if its FMU can do so."""

    def save(self) -> bytes:
        """The FMU state in a form that outlives the instance; raises SlaveError."""

    def restore(self, data: bytes) -> None:
        """Be as at `save`; outputs are those of then from the next get on; raises SlaveError."""
