"""A temporary folder in which FMUs may be unpacked."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cosim.errors import CosimError
from fmukit.errors import UserError, because
from fmukit.places import unpacking_folder


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """A folder that lives as long as the context; raises CosimError where none can be made."""
    try:
        folder = Path(tempfile.mkdtemp(prefix="cosim-", dir=unpacking_folder()))
    except UserError as error:
        raise CosimError(str(error)) from None
    except OSError as error:
        raise CosimError(f"no folder to unpack FMUs into: {because(error)}; set TMPDIR to one") from None
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
