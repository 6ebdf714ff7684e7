"""What computes an instance: the FMU's compiled kernel, or the Python module that stands in its place."""

from __future__ import annotations

import ctypes
from array import array
from collections.abc import Mapping
from pathlib import Path

from .description import Description
from .script import SAID, Script
from .stepping import TOO_LONG, Continuous, Sampled


class Computation:
    """Works on the buffer of one instance, of which it may change derived values, states and outputs.

    `initialise` and `step` return 0, or a code that `reason` puts into words.
    """

    def __init__(
        self,
        about: Description,
        buffer: array[float],
        strings: Mapping[int, str],
        library: ctypes.PyDLL,
        package: Path,
    ) -> None:
        self._about, self._library = about, library
        self._address = buffer.buffer_info()[0]
        self._script = Script(about, buffer, strings, package) if about.program else None
        self._motion = self._moved()
        self.start, self.step = self._motion.start, self._motion.step

    def _moved(self) -> Continuous | Sampled:
        about = self._about
        if about.continuous:
            return Continuous(self._library, self._address, about.max_substep, about.most)
        sample = self._script.sample if self._script else self._library.fmukit_sample
        return Sampled(sample, self._address, 8 * about.size, about.most)

    def initialise(self, seed: int, table: array[float], rows: int) -> int:
        """Compute derived values, first states and outputs; `table` has its cells row by row, of which `rows` count."""
        if self._script:
            return self._script.initialise(table, rows)
        code: int = self._library.fmukit_initialise(self._address, seed, table.buffer_info()[0], float(rows))
        return code

    def reason(self, code: int) -> str:
        """What a code that is not 0 means."""
        scalars = self._about.scalars
        if code == TOO_LONG:
            parts = "substeps" if self._about.continuous else "samples"
            return f"it takes more than {self._about.most} {parts}; take shorter steps"
        if code < 0:
            return self._script.said if self._script else "the kernel reported an error"
        return f"{scalars[code - 1].name if code <= len(scalars) else 'an internal state'} is not a finite number"

    def remedy(self, code: int) -> str:
        """What the user can do when initialisation failed; a Python module has said so itself."""
        return "" if code == SAID else "; check the parameters"
