"""A temporary folder in which FMUs may be unpacked."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from cosim.errors import CosimError
from fmukit.errors import UserError, because
from fmukit.places import unpacking_folder
from fmukit.scratch import scratch


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """A folder that lives as long as the context, or until another run sweeps it when this process is killed.

    Raises CosimError where none can be made.
    """
    with ExitStack() as held:
        try:
            folder = held.enter_context(scratch("cosim-", unpacking_folder()))
        except UserError as error:
            raise CosimError(str(error)) from None
        except OSError as error:
            raise CosimError(f"no folder to unpack FMUs into: {because(error)}; set TMPDIR to one") from None
        yield folder
