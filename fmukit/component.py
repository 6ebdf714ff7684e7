"""One entry of a catalogue of FMUs. Light to import: casadi is loaded when the kernel is asked for."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

from fmukit.interface import Interface

if TYPE_CHECKING:
    from fmukit.kernel import Kernel
    from fmukit.python_kernel import PythonKernel


@dataclass(frozen=True, slots=True)
class Component:
    """The interface, and the module whose `kernel()` returns the component's `Kernel`, or its `PythonKernel`.

    `packages` that the host of the FMU must have: those of the kernel, which names their versions.
    """

    interface: Interface
    model: str
    packages: tuple[str, ...] = ()

    def kernel(self) -> Kernel | PythonKernel:
        """Make the kernel: imports the model, and casadi with it."""
        kernel: Kernel | PythonKernel = import_module(self.model).kernel()
        return kernel
