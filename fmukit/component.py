"""One entry of a catalogue of FMUs. Light to import: casadi is loaded when the kernel is asked for."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from fmukit.interface import Interface

if TYPE_CHECKING:
    from fmukit.kernel import Kernel


@dataclass(frozen=True, slots=True)
class Component:
    """The interface, and the module whose `kernel()` returns the component's `Kernel`."""

    interface: Interface
    model: str

    def kernel(self) -> Kernel:
        """Make the kernel: imports the model, and casadi with it."""
        kernel: Kernel = import_module(self.model).kernel()
        return kernel
