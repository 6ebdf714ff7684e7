"""What is kept for later runs: made once, checked before it is used, pruned only when nobody needs it."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from time import time

import pytest

from fmukit import files, store
from fmukit.errors import BuildError

DATA = bytes(range(256)) * 16
LONG_AGO = time() - 40 * 24 * 3600


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(store, "cache_folder", lambda: tmp_path)
    return tmp_path


def _refuse() -> bytes:
    raise AssertionError("it is made although it is there")


def test_it_is_made_once(root: Path) -> None:
    path = store.kept("thing-1", "thing.so", lambda: DATA)
    assert path == root / "thing-1" / "thing.so"
    assert store.kept("thing-1", "thing.so", _refuse) == path
    assert store.kept("thing-2", "thing.so", lambda: b"other").read_bytes() == b"other"
    assert path.read_bytes() == DATA


@pytest.mark.parametrize(
    "damage",
    [
        lambda path: path.write_bytes(DATA[: int(0.97 * len(DATA))]),
        lambda path: path.write_bytes(DATA[:-1] + b"x"),
        lambda path: path.write_bytes(b""),
        lambda path: path.unlink(),
        lambda path: path.with_name("thing.so.sum").unlink(),
        lambda path: path.with_name("thing.so.sum").write_bytes(b""),
    ],
    ids=["cut", "changed", "empty", "gone", "sum gone", "sum empty"],
)
def test_what_is_damaged_is_made_anew(root: Path, damage: Callable[[Path], object]) -> None:
    path = store.kept("thing-1", "thing.so", lambda: DATA)
    damage(path)
    assert store.kept("thing-1", "thing.so", lambda: DATA).read_bytes() == DATA
    assert store.kept("thing-1", "thing.so", _refuse) == path


def test_what_is_in_use_stays_for_longer_than_a_month(root: Path) -> None:
    used, unused = (store.kept(f"thing-{i}", "thing.so", lambda: DATA) for i in "ab")
    foreign = store.kept("another-a", "thing.so", lambda: DATA)
    for path in (used, unused, foreign):
        os.utime(path, (LONG_AGO, LONG_AGO))
        os.utime(path.parent, (LONG_AGO, LONG_AGO))
    store.kept("thing-a", "thing.so", _refuse)
    store.kept("thing-c", "thing.so", lambda: DATA)
    assert used.is_file()
    assert not unused.parent.exists()
    assert foreign.is_file()


def test_another_process_may_remove_the_same_at_the_same_time(root: Path) -> None:
    """A link to nothing is what a folder looks like that was listed and then removed."""
    old = [root / f"thing-old{i}" for i in range(8)]
    for i, folder in enumerate(old):
        folder.with_name(f"thing-gone{i}").symlink_to("nothing")
        folder.mkdir()
        os.utime(folder, (LONG_AGO, LONG_AGO))
    assert store.kept("thing-2", "thing.so", lambda: DATA).read_bytes() == DATA
    assert not any(folder.exists() for folder in old)


def test_what_cannot_be_removed_does_not_spoil_what_was_made(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    (root / "thing-1").mkdir()
    os.utime(root / "thing-1", (LONG_AGO, LONG_AGO))
    monkeypatch.setattr(store, "rmtree", refuse)
    assert store.kept("thing-2", "thing.so", lambda: DATA).read_bytes() == DATA


def test_a_disk_that_fills_up_is_one_sentence_and_leaves_no_half_file(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(files.os, "replace", full)
    with pytest.raises(BuildError, match=r"^the cache folder .* \(No space left on device\); .*XDG_CACHE_HOME$"):
        store.kept("thing-1", "thing.so", lambda: DATA)
    assert list((root / "thing-1").iterdir()) == []


def test_a_folder_that_cannot_be_written_is_told_before_the_work(root: Path) -> None:
    (root / "thing-1").write_text("in the way")
    with pytest.raises(BuildError, match=r"^the cache folder .*thing-1 cannot be written .*XDG_CACHE_HOME$"):
        store.kept("thing-1", "thing.so", _refuse)
