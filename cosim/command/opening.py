"""What a user names: a scenario that is offered, or the file of a system."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cosim.engine.folder import temporary_folder
from cosim.scenario.definition import Scenario
from cosim.scenario.described import scenario_of
from cosim.scenario.discovery import load, names


@contextmanager
def opened(name: str) -> Iterator[Scenario]:
    """The scenario called `name`, or that of the file `name`; what was unpacked for it lives until the context ends.

    Raises CosimError for a name there is no scenario of, and for what is wrong in a file.
    """
    if Path(name).suffix == ".toml":
        from cosim.system_file.reading import read_system  # noqa: PLC0415 - only for those who have such a file

        yield scenario_of(read_system(Path(name)))
    elif _is_ssp(name):
        from cosim.ssp.reading import read_ssp  # noqa: PLC0415 - the same

        with temporary_folder() as folder:
            yield scenario_of(read_ssp(Path(name), folder))
    else:
        yield load(name)


def _is_ssp(name: str) -> bool:
    """Whether the name is one of a file, or of a folder with an SSD in it; a # may choose one of an SSP."""
    plain = name.partition("#")[0] if not Path(name).exists() else name
    if Path(plain).suffix.lower() in (".ssp", ".ssd"):
        return True
    return Path(name).is_dir() and (name not in names() or any(Path(name).glob("*.ssd")))
