"""What is kept for later runs: made once, checked before it is used, pruned only when nobody needs it."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path
from time import time

import pytest

from fmukit import files, store
from fmukit.compiling.kept import kept
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


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has rights of another kind")
@pytest.mark.parametrize("shared", ["", "..", "../..", "thing.so.sum"])
def test_what_others_may_write_is_refused(root: Path, shared: str) -> None:
    path = store.kept("thing-1", "thing.so", lambda: DATA)
    place = path.with_name(shared) if shared.endswith("sum") else (path / shared).resolve()
    before = place.stat().st_mode
    place.chmod(before | 0o002)
    with pytest.raises(BuildError, match=r"may be written by others \(mode 7?[67][0-7][0-7]\), .* remove it, or name"):
        store.kept("thing-1", "thing.so", _refuse)
    place.chmod(before)
    assert store.kept("thing-1", "thing.so", _refuse) == path


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has rights of another kind")
def test_what_belongs_to_another_user_is_refused(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = store.kept("thing-1", "thing.so", lambda: DATA)
    if os.geteuid():
        monkeypatch.setattr(os, "geteuid", lambda: os.getuid() + 1)
    else:
        os.chown(path, 12345, -1)
    with pytest.raises(BuildError, match="belongs to another user, so it is not used"):
        store.kept("thing-1", "thing.so", _refuse)


def test_the_own_group_may_write(root: Path) -> None:
    """As with the umask 002 of systems that give every user a group."""
    path = store.kept("thing-1", "thing.so", lambda: DATA)
    path.chmod(0o664)
    assert store.kept("thing-1", "thing.so", _refuse) == path


def test_without_a_compiler_what_another_one_made_will_do(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def identity(name: str) -> None:
        def one(_platform: str) -> str:
            if not name:
                raise BuildError("there is no compiler")
            return name

        monkeypatch.setattr("fmukit.compiling.compiler.identity", one)

    identity("")
    with pytest.raises(BuildError, match="there is no compiler"):
        kept("thing", ["source"], "thing.so", _refuse)
    for name in ("gcc", "clang"):
        identity(name)
        path = kept("thing", ["source"], "thing.so", lambda name=name: name.encode())
        assert path.read_bytes() == name.encode()
    os.utime(path.parent, (LONG_AGO, LONG_AGO))
    identity("")
    path = kept("thing", ["source"], "thing.so", _refuse)
    assert path.read_bytes() == b"gcc", "the one used last"
    path.write_bytes(b"half")
    assert kept("thing", ["source"], "thing.so", _refuse).read_bytes() == b"clang"
    with pytest.raises(BuildError, match="there is no compiler"):
        kept("thing", ["other source"], "thing.so", _refuse)
