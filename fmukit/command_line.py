"""Command lines of several subcommands, declared as data and loaded one at a time.

An `Application` names its subcommands and the functions behind them. `run` imports the module of one subcommand when
this one is asked for (to run it, or to show its own help), so that the program's `--help` answers at once whatever the
subcommands need. What goes wrong is told in one sentence on stderr, after the name of the program.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from io import TextIOWrapper
from typing import Any, NoReturn

import typer

from fmukit.errors import UserError, because

MISTAKE, INTERRUPTED = 2, 130
PASS_ON = {"allow_interspersed_args": False, "ignore_unknown_options": True}
"""Settings of a subcommand whose options, from its first argument on, belong to a program it starts."""
_HELP_NOT_ASKED = {"default_map": {"help": False}}
"""Without it typer takes the absent `--help` for a value to convert, and imports a package for that (50 ms)."""


@dataclass(frozen=True, slots=True)
class Subcommand:
    """`function` is "module:function" with the parameters as typer reads them; `settings` are those of its context.

    `help` is the line in the help of the program; the function's docstring is the help of the subcommand itself.
    """

    name: str
    help: str
    function: str
    settings: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Application:
    """A program and its subcommands; `further` finds those that other packages bring (see `installed_commands`).

    `told` are the errors whose message is a sentence for the user, with the exit status each gives. Of an OSError
    the sentence is the file and the reason.
    """

    name: str
    help: str
    subcommands: tuple[Subcommand, ...]
    told: Mapping[type[Exception], int] = field(default_factory=dict)
    further: Callable[[], Sequence[Subcommand]] = tuple


def run(application: Application, arguments: Sequence[str] | None = None) -> NoReturn:
    """Do what the arguments (default: those of the process) say, and end the process with the exit status.

    The status is 2 for arguments that make no sense, 130 after an interrupt, that of `Application.told` for the errors
    named there, else what the subcommand returns.
    """
    given = list(sys.argv[1:] if arguments is None else arguments)
    _print_anything()
    try:
        with _ends_as_interrupts():
            status = _app(application, given)(given, prog_name=application.name, standalone_mode=False)
    except typer.TyperException as error:
        _end(application, f"{_usage(error)} `{application.name} --help` shows what there is", MISTAKE)
    except (typer.Abort, KeyboardInterrupt):
        status = INTERRUPTED
    except tuple(application.told) as error:
        _end(application, _sentence(error), _status(application, error))
    if status == INTERRUPTED:
        _end(application, "interrupted", INTERRUPTED)
    sys.exit(status or 0)


def interrupting() -> tuple[signal.Signals, ...]:
    """The signals that ask a program to end, but for those it was told to ignore, as nohup does."""
    kinds = (getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
    return tuple(kind for kind in kinds if signal.getsignal(kind) != signal.SIG_IGN)


@contextmanager
def _ends_as_interrupts() -> Iterator[None]:
    """Every request to end is told and cleaned up after like Ctrl-C."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    previous = {kind: signal.signal(kind, signal.default_int_handler) for kind in interrupting()}
    try:
        yield
    finally:
        for kind, handler in previous.items():
            signal.signal(kind, handler)


def _print_anything() -> None:
    """Names of files may hold bytes that are no text, and a terminal may have few characters."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def _app(application: Application, given: Sequence[str]) -> typer.Typer:
    """The program with the function of the one subcommand that is asked for, and the names of the others."""
    asked = next((argument for argument in given if argument != "--"), "")
    app = typer.Typer(
        help=application.help,
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,
        context_settings=_HELP_NOT_ASKED,
    )
    app.callback()(_nothing)
    for subcommand in _subcommands(application, asked):
        if subcommand.name == asked:
            settings = {**_HELP_NOT_ASKED, **subcommand.settings}
            app.command(subcommand.name, context_settings=settings)(loaded(subcommand.function))
        else:
            app.command(subcommand.name, help=subcommand.help)(_nothing)
    return app


def _subcommands(application: Application, asked: str) -> list[Subcommand]:
    """The program's own subcommands and, unless one of them is asked for, the further ones."""
    own = list(application.subcommands)
    return own if asked in [subcommand.name for subcommand in own] else [*own, *application.further()]


def loaded(function: str) -> Any:
    """The function named "module:function"; imports the module. Raises UserError when that cannot be."""
    module, _, name = function.partition(":")
    try:
        return getattr(import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise UserError(f"the command at {function} cannot be loaded: {error}") from None


def _nothing() -> None:
    """Stands for a function that is not asked for."""


def _usage(error: typer.TyperException) -> str:
    """What is wrong with the arguments, with the option it is about, as the beginning of a sentence."""
    text = " ".join(error.format_message().split()).rstrip(".") or "say what to do"
    return text if text.endswith("?") else f"{text};"


def _sentence(error: Exception) -> str:
    if isinstance(error, OSError):
        return f"{error.filename}: {because(error)}" if error.filename else because(error)
    return str(error)


def _status(application: Application, error: Exception) -> int:
    return next(status for kind, status in application.told.items() if isinstance(error, kind))


def _end(application: Application, sentence: str, status: int) -> NoReturn:
    print(f"{application.name}: {sentence}", file=sys.stderr)
    sys.exit(status)
