"""`fmus host`: a program that loads FMUs, run with what Python FMUs need."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from typing import Annotated, NoReturn

import typer

from fmukit.errors import UserError
from fmukit.hosting.environment import environment, libpython


def host(
    command: Annotated[list[str], typer.Argument(metavar="-- TOOL [ARG]...", help="The program and its arguments.")],
) -> NoReturn:
    """Run a program that loads FMUs, with the environment Python FMUs need in it; ends with its exit status."""
    made = environment(os.environ)
    tool = shutil.which(command[0], path=made["PATH"])
    if tool is None:
        raise UserError(f"there is no program {command[0]!r} on PATH; name one that is, or give its path")
    if libpython() is None:
        print("fmus: this Python has no shared library, so only hosts written in Python will do", file=sys.stderr)
    sys.stdout.flush()
    if sys.platform == "win32":
        sys.exit(subprocess.run([tool, *command[1:]], env=made, check=False).returncode)
    os.execve(tool, command, made)
