"""Command lines as data: what is imported when, what the user is told, and which exit status ends the process."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from fmukit.command_line import PASS_ON, Application, Subcommand, run
from fmukit.docstrings import first_line
from fmukit.installed_commands import installed

Program = Callable[..., tuple[object, str, str]]

GREETING = '''"""Greets."""

import typer


class Broken(Exception):
    pass


def greet(name: str, times: int = 1) -> None:
    """Greet somebody.

    More than once if asked to.
    """
    print(f"hello {name} " * times)


def fail(how: str) -> None:
    """Fail."""
    raise {
        "mistake": ValueError("this is wrong"),
        "failure": Broken("it broke"),
        "disk": OSError(28, "No space left on device", "file.txt"),
        "library": OSError("Writing failed. Detail: [errno 28] No space left on device"),
        "interrupt": KeyboardInterrupt(),
        "status": typer.Exit(7),
    }[how]


def pass_on(command: list[str]) -> None:
    """Print the arguments."""
    print(command)
'''
SUBCOMMANDS = (
    Subcommand("greet", "Greet somebody.", "greeting.words:greet"),
    Subcommand("fail", "Fail.", "greeting.words:fail"),
    Subcommand("pass", "Print the arguments.", "greeting.words:pass_on", PASS_ON),
    Subcommand("lost", "What cannot be imported.", "greeting.nowhere:lost"),
)


@pytest.fixture
def greeting(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder on the module path with the package `greeting`, of which nothing is imported yet."""
    (tmp_path / "greeting").mkdir()
    (tmp_path / "greeting" / "__init__.py").write_text("")
    (tmp_path / "greeting" / "words.py").write_text(GREETING)
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("greeting", "greeting.words"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    return tmp_path


@pytest.fixture
def program(greeting: Path, capsys: pytest.CaptureFixture[str]) -> Program:
    """program(ARGUMENTS) gives exit status, stdout and stderr."""
    told: dict[type[Exception], int] = {ValueError: 2, OSError: 1, Exception: 3}

    def ran(*arguments: str, **more: object) -> tuple[object, str, str]:
        with pytest.raises(SystemExit) as end:
            run(Application("hi", "Greetings.", SUBCOMMANDS, told, **more), arguments)  # type: ignore[arg-type]
        return end.value.code, *capsys.readouterr()

    return ran


def test_a_subcommand_gets_its_arguments(program: Program) -> None:
    assert program("greet", "you", "--times", "2") == (0, "hello you hello you \n", "")
    assert program("pass", "tool", "--json", "-x", "--", "1") == (0, "['tool', '--json', '-x', '--', '1']\n", "")


def test_the_help_of_the_program_imports_no_subcommand(program: Program) -> None:
    status, out, err = program("--help")
    assert (status, err) == (0, "")
    assert "Greetings." in out
    for subcommand in SUBCOMMANDS:
        assert f" {subcommand.name} " in out
        assert subcommand.help in out
    assert "greeting" not in sys.modules


def test_the_help_of_a_subcommand_is_its_docstring(program: Program) -> None:
    status, out, _ = program("greet", "--help")
    assert status == 0
    assert "Usage: hi greet [OPTIONS] {name}" in out
    assert "More than once if asked to." in out


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["gret"], "hi: No such command 'gret'. Did you mean 'greet'? `hi --help` shows what there is"),
        (["greet"], "hi: Missing argument 'name'; `hi --help` shows what there is"),
        (["greet", "you", "--loud"], "hi: No such option: --loud; `hi --help` shows what there is"),
        (["--loud"], "hi: No such option: --loud; `hi --help` shows what there is"),
        (["fail", "mistake"], "hi: this is wrong"),
    ],
)
def test_a_mistake_is_one_sentence_and_status_2(program: Program, arguments: list[str], sentence: str) -> None:
    assert program(*arguments) == (2, "", f"{sentence}\n")


def test_without_arguments_the_help_is_shown(program: Program) -> None:
    status, out, err = program()
    assert status == 2
    assert "Greetings." in out
    assert err == "hi: say what to do; `hi --help` shows what there is\n"


@pytest.mark.parametrize(
    ("how", "status", "sentence"),
    [
        ("failure", 3, "hi: it broke\n"),
        ("disk", 1, "hi: file.txt: No space left on device\n"),
        ("library", 1, "hi: No space left on device\n"),
        ("interrupt", 130, "hi: interrupted\n"),
        ("status", 7, ""),
    ],
)
def test_how_it_ends(program: Program, how: str, status: int, sentence: str) -> None:
    assert program("fail", how) == (status, "", sentence)


def test_further_subcommands_are_looked_for_only_when_none_of_its_own_is_meant(program: Program) -> None:
    looked = []

    def further() -> list[Subcommand]:
        looked.append(True)
        return [Subcommand("again", "Greet again.", "greeting.words:greet")]

    assert program("greet", "you", further=further)[0] == 0
    assert not looked
    assert "Greet again." in program("--help", further=further)[1]
    assert program("again", "you", further=further) == (0, "hello you \n", "")


def test_installed_subcommands_show_the_first_line_of_their_function(greeting: Path) -> None:
    about = greeting / "greeting-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: greeting\nVersion: 1.0\n")
    points = {"welcome": "greeting.words:greet", "bye": "greeting.words:nobody", "lost": "greeting.nowhere:lost"}
    lines = ["[hi.commands]", *(f"{name} = {function}" for name, function in points.items())]
    (about / "entry_points.txt").write_text("\n".join(lines))
    assert installed("hi.commands") == [
        Subcommand("bye", "", "greeting.words:nobody"),
        Subcommand("lost", "", "greeting.nowhere:lost"),
        Subcommand("welcome", "Greet somebody.", "greeting.words:greet"),
    ]
    assert installed("other.commands") == []
    assert "greeting" not in sys.modules


def test_first_lines_are_read_from_the_source() -> None:
    assert first_line("fmukit.docstrings:first_line").startswith("The first line of the docstring of")
    assert first_line("sys:exit") == ""
