"""The project's pages of Markdown, and what is in them: fenced blocks, code spans, links, headings."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

ROOT = Path(__file__).parents[2]
_FOLDERS = ("docs", "fmukit", "fmus", "cosim", "scenarios", "benchmarks", "tests")
_MARK = re.compile(r"<!-- command: (\w+) -->")


@dataclass(frozen=True, slots=True)
class Block:
    """A fenced block at `line`: the `tag` of its language, the `note` after it, and its `content`.

    `mark` is the name in a comment `<!-- command: NAME -->` just before it; an indented block has the tag "".
    """

    line: int
    tag: str
    note: str
    content: str
    mark: str = ""


@dataclass(frozen=True, slots=True)
class Page:
    """One file, with the words after which tests are named."""

    path: Path

    @property
    def name(self) -> str:
        return self.path.relative_to(ROOT).as_posix()

    @property
    def text(self) -> str:
        return self.path.read_text("utf-8")

    def blocks(self) -> list[Block]:
        """All fenced and indented blocks, in order."""
        return list(_blocks(_tokens(self.path)))

    def spans(self) -> list[str]:
        """The texts in backticks outside of blocks."""
        return [child.content for child in self._inline() if child.type == "code_inline"]

    def links(self) -> list[str]:
        """Where links and pictures lead."""
        targets = (child.attrGet("href") or child.attrGet("src") for child in self._inline())
        return [str(target) for target in targets if target]

    def anchors(self) -> set[str]:
        """The headings as GitHub names them in links."""
        pairs = pairwise(_tokens(self.path))
        titles = [after.content for token, after in pairs if token.type == "heading_open"]
        return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}

    def _inline(self) -> Iterator[Token]:
        for token in _tokens(self.path):
            yield from token.children or ()


def pages() -> list[Page]:
    """All pages but the changelog, which may speak of what is gone."""
    own = [path for path in ROOT.glob("*.md") if path.name != "CHANGELOG.md"]
    found = [path for folder in _FOLDERS for path in (ROOT / folder).rglob("*.md")]
    return [Page(path) for path in sorted(own + found)]


@cache
def _tokens(path: Path) -> list[Token]:
    return MarkdownIt("commonmark").enable("table").parse(path.read_text("utf-8"))


def _blocks(tokens: list[Token]) -> Iterator[Block]:
    mark = ""
    for token in tokens:
        if token.type in ("fence", "code_block"):
            tag, _, note = token.info.strip().partition(" ")
            yield Block(token.map[0] + 1 if token.map else 0, tag, note.strip(), token.content, mark)
        found = _MARK.fullmatch(token.content.strip()) if token.type == "html_block" else None
        mark = found[1] if found else ""
