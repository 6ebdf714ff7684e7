"""The `fmus` program, run in this process."""

from __future__ import annotations

import io
import os
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from unittest.mock import patch

from fmukit.command_line import run
from fmus.command.main import APPLICATION


@dataclass(frozen=True)
class Done:
    """What the program left: its exit status and what it printed, on lines of 200 characters."""

    status: object
    out: str
    err: str


def fmus(*arguments: object) -> Done:
    out, err = io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err), patch.dict(os.environ, COLUMNS="200"):
        try:
            run(APPLICATION, [str(argument) for argument in arguments])
        except SystemExit as end:
            return Done(end.code, out.getvalue(), err.getvalue())
