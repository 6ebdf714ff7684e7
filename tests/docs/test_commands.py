"""Every block of every page runs, or is read, or says why it cannot."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import doc_commands as commands
import pytest
from doc_blocks import PARSERS, READERS, RUN, done, is_source
from doc_pages import ROOT, Page, pages

PAGES = [page for page in pages() if page.blocks()]
OF_A_USER = re.compile(r"^\s*(fmus|cosim|python3?|pip|pytest|>>>|\$) ", re.M)
needs_bash = pytest.mark.skipif(shutil.which("bash") is None, reason="the commands are written for bash")
every_page = pytest.mark.parametrize("page", pages(), ids=lambda page: page.name)
every_page_with_blocks = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)


def has_plan() -> bool:
    return bool(commands.help_of("fmus", "plan"))


def test_plans_are_made_by_fmus() -> None:
    assert has_plan(), "the documents say `fmus plan`, which is not there: the tests of commands leave it out"


@every_page_with_blocks
def test_every_block_says_what_it_is(page: Page) -> None:
    """Nothing is passed over in silence: `text` holds no commands but for a reason."""
    for block in page.blocks():
        place = f"{page.name}:{block.line}"
        assert block.tag in (*RUN, *PARSERS, "text"), f"{place}: the language of the block is {block.tag!r}"
        if block.tag == "text":
            reason = re.fullmatch(r"not run: .+", block.note)
            assert reason or not block.note, f"{place}: write ```text, or ```text not run: REASON"
            assert reason or not OF_A_USER.search(block.content), f"{place}: commands belong into ```sh"
        elif block.tag in PARSERS:
            assert block.note in READERS, f"{place}: name the file after the language, one of {', '.join(READERS)}"
        else:
            assert block.note in ("", "nightly") or is_source(block), f"{place}: what is {block.note!r}?"


@needs_bash
@every_page_with_blocks
def test_blocks_run(page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    for block in page.blocks():
        if block.note != "nightly" and not block.mark:
            wrong = done(block, tmp_path, lambda line: _now(line) and not commands.takes_long(line))
            assert not wrong.strip(), f"{page.name}:{block.line}: {wrong}"


@needs_bash
@pytest.mark.nightly
@every_page_with_blocks
def test_long_blocks_run(page: Page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The whole of `python -m benchmarks` has a nightly test of its own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    for block in page.blocks():
        if block.note == "nightly" or block.tag == "sh":
            every = block.note == "nightly"
            left = [line for line in commands.lines(block.content) if every or commands.takes_long(line)]
            wrong = done(block, tmp_path, lambda line, left=left: line in left and line != "python -m benchmarks")
            assert not wrong.strip(), f"{page.name}:{block.line}: {wrong}"


def _now(command: str) -> bool:
    return has_plan() or not command.startswith("fmus plan")


@every_page
def test_commands_are_known(page: Page) -> None:
    """Also those that are not run: within sentences, with names in capitals, and of nightly blocks."""
    scripts = [line for block in page.blocks() if block.tag == "sh" for line in commands.lines(block.content)]
    ours = [text for text in (*page.spans(), *scripts) if re.match(rf"({'|'.join(commands.OURS)}) \S", text)]
    wrong = [commands.unknown(command) for command in ours if _now(command)]
    assert not any(wrong), "; ".join(filter(None, wrong))


@every_page
def test_options_within_sentences_are_known(page: Page) -> None:
    known = {option for command in _commands() for option in re.findall(r"--[a-z][a-z-]+", commands.help_of(*command))}
    spans = [span for span in page.spans() if not span.startswith("ruff")]
    named = {word for span in spans for word in span.split() if re.fullmatch(r"--[a-z][a-z-]+", word)}
    assert named <= known | {"--help"}, named - known


def _commands() -> list[tuple[str, str]]:
    ours = {"fmus": "list build check host doctor plan", "cosim": "list run export replay convert compare show plan"}
    return [(program, name) for program, names in ours.items() for name in names.split()]


def test_marked_blocks_are_those_that_the_gate_runs() -> None:
    """`.ci/run` executes the quick start in clones of its own."""
    gate = (ROOT / ".ci" / "run").read_text("utf-8")
    marked = [(page.name, block.mark) for page in PAGES for block in page.blocks() if block.mark]
    assert sorted(marked) == sorted(("README.md", name) for name in re.findall(r"^readme (\w+)$", gate, re.M))


@pytest.mark.parametrize(
    ("command", "shorter"),
    [
        ("cosim run platoon --stop-time 40", "cosim run platoon --stop-time 0.2 --no-report"),
        (
            "cosim run platoon --at 5:mpc.x=1",
            "cosim run platoon --at 0.1:mpc.x=1 --stop-time 0.2 --no-report",
        ),
        ("fmus build -d out", "fmus build Imu -d out"),
        ("fmus check out/*.fmu", "fmus check out/*.fmu --groups AX"),
        ("cosim list", "cosim list"),
    ],
)
def test_what_is_run_in_place_of_a_long_command(command: str, shorter: str) -> None:
    assert commands.cheap(command) == shorter


def test_what_is_not_there_is_named(tmp_path: Path) -> None:
    assert commands.lines("a  # why\n\n# only why\nb \\\n  c\n") == ["a", "b    c"]
    assert "has no option --no-such" in commands.unknown("cosim run NAME --no-such 3 --seed 1")
    assert "there is no command cosim walk" in commands.unknown("cosim walk")
    assert "no test is named nothing_of_that" in commands.tests_missing(
        "pytest tests/docs -k 'what or nothing_of_that'"
    )
    assert "there is no tests/none" in commands.tests_missing("pytest -m nightly tests/none")
    assert "ends with 3: gone" in commands.executed("echo gone >&2; exit 3", tmp_path)
