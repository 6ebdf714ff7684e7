"""The `fmus` command: its subcommands, and what becomes of a mistake."""

from __future__ import annotations

import logging

from fmukit.command_line import MISTAKE, PASS_ON, Application, Subcommand, run
from fmukit.errors import UserError

APPLICATION = Application(
    name="fmus",
    help="FMUs of the vehicle and formation control system.",
    subcommands=(
        Subcommand("list", "Show the catalogue: name, kind, step and ports of every FMU.", "fmus.command.list:show"),
        Subcommand("build", "Build FMUs into a folder and print their paths.", "fmus.command.build:build"),
        Subcommand(
            "plan",
            "Plan the time-optimal motion along a road; ReferenceTrajectory plays the file.",
            "fmus.planner.command:plan_command",
        ),
        Subcommand(
            "check",
            "Check FMI 2.0 co-simulation FMUs: archive, model description, life cycle, behaviour, isolation.",
            "fmukit.conformance.command:check_files",
        ),
        Subcommand(
            "host",
            "Run a program that loads FMUs, with the environment Python FMUs need in it.",
            "fmukit.hosting.host_command:host",
            PASS_ON,
        ),
        Subcommand(
            "doctor",
            "Say what of platform, compiler, libpython and cache folder is missing, and how to get it.",
            "fmukit.hosting.doctor_command:doctor",
        ),
    ),
    told={UserError: MISTAKE, OSError: MISTAKE},
)


def main() -> None:
    """Entry point; ends the process."""
    # Where matplotlib cannot keep its own cache it says at length that it goes on without; the pictures are the same.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    run(APPLICATION)
