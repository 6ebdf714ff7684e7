"""The FMI callbacks of one instance: life cycle, step, values and state.

Nothing ever raises across the FMI boundary: PythonFMU would turn it into a fatal error and damage its reference
counts. See `core` for what happens instead.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, ClassVar

from pythonfmu import Fmi2Slave

from .access import RefusalError
from .core import Core
from .description import Description
from .leaving import release_interpreter_once
from .life import INITIALISING, INSTANTIATED, MODES, STEPPING, TERMINATED
from .state import Refused, Snapshot, from_bytes, to_bytes
from .steps import Steps
from .values import Values


class EmbeddedSlave(Fmi2Slave):
    """One instance of an FMU. The class made for an FMU carries its description and the name of its package."""

    description_: ClassVar[Description]
    package: ClassVar[str]

    def __init__(self, **kwargs: Any) -> None:
        super().__init__(**kwargs)
        resources = Path(str(kwargs.get("resources")))
        self._core = Core(self.description_, resources, self.log_queue)
        self._values = Values(self._core)
        self._steps = Steps(self._core)
        if "logger" in kwargs:
            _leave_path(str(kwargs.get("resources")))
            self._core.attach(resources / self.package)
            release_interpreter_once(resources.parent / "binaries" / "linux64" / f"{self.description_.name}.so")

    # life cycle

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Only checked: time starts where the first step does, and the step is the host's to choose."""
        self._expect("setupExperiment", INSTANTIATED)

    def enter_initialization_mode(self) -> None:
        """From now on outputs read belong to the parameters and inputs set so far."""
        if self._expect("enterInitializationMode", INSTANTIATED):
            self._enter(INITIALISING)

    def exit_initialization_mode(self) -> None:
        """Compute derived values, first states and outputs; what cannot be is told, and every step is discarded."""
        if not self._expect("exitInitializationMode", INITIALISING):
            return
        self._enter(STEPPING)
        try:
            self._core.initialise()
            self._core.advise()
        except BaseException as error:
            self._core.break_down(error)

    def terminate(self) -> None:
        """Outputs can still be read; nothing can be set."""
        if self._expect("terminate", STEPPING):
            self._enter(TERMINATED)

    def _expect(self, call: str, mode: int) -> bool:
        present = self._core.life.mode
        if present != mode:
            self._core.refuse(
                RefusalError(f"{call} is not allowed in the state '{MODES[present]}'; the call is ignored")
            )
        return present == mode

    def _enter(self, mode: int) -> None:
        self._core.life.mode = mode
        self._values.forget()

    # time

    def do_step(self, current_time: float, step_size: float) -> bool:
        """One step [s]; False when it was discarded: the outputs stay, `fault` is true and the reason is logged."""
        return self._steps.take(current_time, step_size)

    # values

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values at the value references; NaN for all of them when the call is refused."""
        try:
            return self._values.reals(vrs)
        except BaseException as error:
            self._core.complain(error)
            return [float("nan")] * len(vrs)

    def set_real(self, vrs: list[int], values: list[float]) -> None:
        """Store all values, or none when one may not be set or is outside its limits."""
        try:
            self._values.set_reals(vrs, values)
        except BaseException as error:
            self._core.refuse(error)

    def get_integer(self, vrs: list[int]) -> list[int]:
        """As `get_real`; zeros when the call is refused."""
        return self._got(vrs, "Integer", 0)

    def set_integer(self, vrs: list[int], values: list[int]) -> None:
        """As `set_real`."""
        self._set(vrs, "Integer", values)

    def get_boolean(self, vrs: list[int]) -> list[bool]:
        """As `get_real`; False when the call is refused."""
        return self._got(vrs, "Boolean", False)

    def set_boolean(self, vrs: list[int], values: list[bool]) -> None:
        """As `set_real`."""
        self._set(vrs, "Boolean", values)

    def get_string(self, vrs: list[int]) -> list[str]:
        """As `get_real`; empty texts when the call is refused."""
        return self._got(vrs, "String", "")

    def set_string(self, vrs: list[int], values: list[str]) -> None:
        """Store all texts, or none; they are read at initialisation."""
        self._set(vrs, "String", values)

    def _got(self, vrs: list[int], type_: str, otherwise: Any) -> list[Any]:
        try:
            return self._values.get(vrs, type_)
        except BaseException as error:
            self._core.complain(error)
            return [otherwise] * len(vrs)

    def _set(self, vrs: list[int], type_: str, values: list[Any]) -> None:
        try:
            self._values.set(vrs, type_, values)
        except BaseException as error:
            self._core.refuse(error)

    # state

    def _get_fmu_state(self) -> Snapshot:
        return self._core.snapshot()

    def _set_fmu_state(self, snapshot: Any) -> None:
        try:
            if not isinstance(snapshot, Snapshot) or len(snapshot.buffer) != 8 * self.description_.size:
                reason = snapshot.reason if isinstance(snapshot, Refused) else "it is not a state of this FMU"
                raise RefusalError(f"the FMU state is refused: {reason}; the present state is kept")
            self._core.restore(snapshot)
            self._values.forget()
        except BaseException as error:
            self._core.refuse(error)

    @classmethod
    def _fmu_state_to_bytes(cls, snapshot: Any) -> bytes:
        """PythonFMU calls this and the next on the class: there is no instance to raise a fault on."""
        try:
            return to_bytes(snapshot, cls.description_)
        except BaseException:
            return b""

    @classmethod
    def _fmu_state_from_bytes(cls, data: bytes) -> Snapshot | Refused:
        try:
            return from_bytes(bytes(data), cls.description_)
        except BaseException as error:
            return Refused(f"the bytes cannot be read ({type(error).__name__})")


def _leave_path(resources: str) -> None:
    """Remove the entry PythonFMU puts on the module path for every instance and never takes away."""
    if resources in sys.path:
        sys.path.remove(resources)
