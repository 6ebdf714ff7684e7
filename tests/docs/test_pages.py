"""What pages name exists: links, files, modules. And they are short."""

from __future__ import annotations

import re
from importlib import import_module
from importlib.util import find_spec

import pytest
from doc_pages import ROOT, Page, pages

WORDS = 14_500
"""Most in all README.md files: a user reads a README as a whole, so measurements and comparisons go to docs/studies."""
NO_MODULES = {"cosim.scenarios", "cosim.models"}
"""Names of entry point groups."""
PACKAGES = ("fmukit", "fmus", "cosim", "scenarios", "benchmarks")
TOP = (*PACKAGES, "docs", "tests", ".ci")
every_page = pytest.mark.parametrize("page", pages(), ids=lambda page: page.name)


@every_page
def test_links_lead_somewhere(page: Page) -> None:
    for link in page.links():
        if re.match(r"https?://", link):
            continue
        file, _, anchor = link.partition("#")
        target = (page.path.parent / file).resolve() if file else page.path
        assert target.exists(), f"{page.name}: {link}"
        assert not anchor or anchor in Page(target).anchors(), f"{page.name}: {link}"


@every_page
def test_files_named_exist(page: Page) -> None:
    shown = {block.note for block in page.blocks()}
    for span in page.spans():
        if re.fullmatch(r"[\w.-]+(/[\w.-]+)*/?", span) and _is_file(span) and span not in shown:
            beside = (page.path.parent / span, page.path.parent.parent / span)
            assert (ROOT / span).exists() or any(path.exists() for path in beside), f"{page.name}: {span}"


def _is_file(name: str) -> bool:
    """A path from the top of the checkout, or the name of a source; what a run writes is neither."""
    return (name.split("/", maxsplit=1)[0] in TOP and "/" in name) or bool(re.search(r"\w\.(py|toml|md|c|h)$", name))


@every_page
def test_modules_named_exist(page: Page) -> None:
    for name in page.spans():
        if re.fullmatch(rf"({'|'.join(PACKAGES)})(\.\w+)+", name) and name not in NO_MODULES:
            assert _found(name), f"{page.name}: there is no {name}"


def _found(name: str) -> bool:
    """A module, or something in one."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            spec = find_spec(".".join(parts[:count]))
        except ModuleNotFoundError:
            spec = None
        if spec is not None:
            inside: object = import_module(".".join(parts[:count])) if count < len(parts) else None
            for part in parts[count:]:
                inside = getattr(inside, part, None)
            return count == len(parts) or inside is not None
    return False


def test_readmes_are_short() -> None:
    words = {page.name: len(page.text.split()) for page in pages() if page.path.name == "README.md"}
    assert sum(words.values()) <= WORDS, words


def test_the_glossary_is_in_order() -> None:
    text = (ROOT / "docs" / "conventions.md").read_text("utf-8").partition("## Glossary")[2]
    words = [row.split("|")[1].strip().lower() for row in text.splitlines() if row.startswith("| ")][1:]
    assert len(words) > 30
    assert words == sorted(words)
