"""`fmus host` and `fmus doctor`."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from typing import Annotated, NoReturn

import typer

PASS_ON = {"allow_interspersed_args": False, "ignore_unknown_options": True}


def host_command(
    command: Annotated[list[str], typer.Argument(metavar="-- TOOL [ARG]...", help="The program and its arguments.")],
) -> NoReturn:
    """Run a program that loads FMUs, with the environment Python FMUs need in it; ends with its exit status."""
    from fmukit.hosting.environment import environment, libpython  # noqa: PLC0415  (lazy: `--help` answers at once)

    made = environment(os.environ)
    tool = shutil.which(command[0], path=made["PATH"])
    if tool is None:
        raise typer.BadParameter(f"there is no program {command[0]!r} on PATH.")
    if libpython() is None:
        print("fmus: this Python has no shared library, so only hosts written in Python will do", file=sys.stderr)
    sys.stdout.flush()
    if sys.platform == "win32":
        sys.exit(subprocess.run([tool, *command[1:]], env=made, check=False).returncode)
    os.execve(tool, command, made)


def doctor_command() -> None:
    """Say what of platform, compiler, libpython and cache folder is missing, and how to get it."""
    from fmukit.hosting.environment import findings  # noqa: PLC0415

    missing = []
    for finding in findings():
        print(f"{'ok' if finding.there else 'missing':9}{finding.thing:14}{finding.seen}")
        if not finding.there:
            missing.append(f"{finding.thing}: {finding.remedy}")
    for sentence in missing:
        print(sentence)
    raise typer.Exit(1 if missing else 0)
