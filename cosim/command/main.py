"""The `cosim` command."""

from __future__ import annotations

import sys
from importlib.metadata import entry_points
from typing import Any, NoReturn

import typer

from cosim.command.export import export_command
from cosim.command.list import list_command
from cosim.command.run import run_command
from cosim.errors import CosimError, RunFailedError, RunInterruptedError, because

app = typer.Typer(
    help="Run systems of FMI 2.0 co-simulation FMUs.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

_FAILED, _MISTAKE, _INTERRUPTED = 1, 2, 130
_UsageError: type[Exception] = typer.BadParameter.__mro__[1]  # of the click inside typer, without a public name


def main() -> None:
    """Entry point: whatever goes wrong is one sentence on stderr.

    Exit status 2 for a mistake of the user, 1 for a run that failed, 130 for one that was interrupted.
    """
    try:
        sys.exit(app(standalone_mode=False) or 0)
    except CosimError as error:
        _end(str(error), _MISTAKE)
    except RunInterruptedError as error:
        _end(str(error), _INTERRUPTED)
    except RunFailedError as error:
        _end(str(error), _FAILED)
    except _UsageError as error:
        _end(f"{_usage(error)}; `cosim --help` shows what there is", _MISTAKE)
    except typer.Abort:
        _end("interrupted", _INTERRUPTED)
    except OSError as error:  # whatever was not foreseen where it happens
        _end(f"{error.filename}: {because(error)}" if error.filename else because(error), _FAILED)


def _usage(error: Any) -> str:
    """One sentence, with the option it is about."""
    return " ".join(error.format_message().split()).rstrip(".?") or "say what to do"


def _end(sentence: str, status: int) -> NoReturn:
    print(f"cosim: {sentence}", file=sys.stderr)
    sys.exit(status)


app.command("list")(list_command)
app.command("run")(run_command)
app.command("export")(export_command)
for entry in entry_points(group="cosim.commands"):
    app.command(entry.name)(entry.load())
