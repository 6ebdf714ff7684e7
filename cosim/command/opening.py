"""What a user names: a scenario that is offered, or the file of a system."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cosim.scenario.definition import Scenario
from cosim.scenario.described import scenario_of
from cosim.scenario.discovery import load


@contextmanager
def opened(name: str) -> Iterator[Scenario]:
    """The scenario called `name`, or that of the file `name`; what was unpacked for it lives until the context ends.

    Raises CosimError for a name there is no scenario of, and for what is wrong in a file.
    """
    if Path(name).suffix == ".toml":
        from cosim.system_file.reading import read_system  # noqa: PLC0415 - only for those who have such a file

        yield scenario_of(read_system(Path(name)))
    else:
        yield load(name)
