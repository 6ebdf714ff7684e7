"""The `cosim` command: what it is made of. Each subcommand is imported only when it is asked for."""

from __future__ import annotations

from functools import partial
from typing import NoReturn

from cosim.errors import RunFailedError, RunInterruptedError
from fmukit.command_line import INTERRUPTED, MISTAKE, Application, Subcommand, run
from fmukit.errors import UserError
from fmukit.installed_commands import installed

FAILED = 1
GROUP = "cosim.commands"
"""The entry point group through which other packages add subcommands."""

APPLICATION = Application(
    name="cosim",
    help="Run systems of FMI 2.0 co-simulation FMUs.",
    subcommands=(
        Subcommand("list", "Show the scenarios with what each reproduces.", "cosim.command.list:list_command"),
        Subcommand("run", "Run a scenario and write its results.", "cosim.command.run:run_command"),
        Subcommand("export", "Write a scenario as SSP 1.0, for other tools.", "cosim.command.export:export_command"),
        Subcommand("replay", "Feed a system from a log of real sensors.", "cosim.command.replay:replay_command"),
        Subcommand("convert", "Write results as CSV, MAT or MDF.", "cosim.command.results:convert_command"),
        Subcommand("compare", "Hold two runs against each other.", "cosim.command.results:compare_command"),
        Subcommand("show", "Plot signals of a run.", "cosim.command.results:show_command"),
    ),
    told={
        UserError: MISTAKE,
        RunInterruptedError: INTERRUPTED,
        RunFailedError: FAILED,
        OSError: FAILED,  # whatever was not foreseen where it happens
    },
    further=partial(installed, GROUP),
)


def main() -> NoReturn:
    """Entry point. The exit status is 2 for a mistake, 1 for a run that failed, 130 for one that was interrupted."""
    run(APPLICATION)
