"""Files of parameter values: TOML, as tables or with dotted names."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from cosim.errors import CosimError
from cosim.system_file.decoding import read_toml


def read_parameters(file: Path) -> list[tuple[str, str]]:
    """(instance.variable, text of its value) of all values in the file, in its order; raises CosimError.

    `[hlc]` with `gain = 2` and `"hlc.gain" = 2` say the same.
    """
    return list(_flat(read_toml(file), "", file))


def _flat(values: Mapping[str, Any], prefix: str, file: Path) -> Iterator[tuple[str, str]]:
    for name, value in values.items():
        full = f"{prefix}{name}"
        if isinstance(value, Mapping):
            yield from _flat(value, f"{full}.", file)
        elif isinstance(value, bool | int | float | str):
            if not prefix and "." not in name:
                raise CosimError(
                    f"{file}: {name} belongs to no instance; write [instance] above it, or instance.{name}"
                )
            yield full, str(value).lower() if isinstance(value, bool) else str(value)
        else:
            raise CosimError(f"{file}: {full} is {value!r}; give a number, true, false or a text")
