"""FMUs are unpacked where the library of PythonFMU can read the path: it decodes no escape of a URI but %20."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from fmukit import places
from fmukit.errors import UserError
from fmukit.places import is_plain, unpacking_folder

ODD = ["größe", "a%20b", "a#b", "a&b", "a+b", "it's", "[x]", "a;b", "日本"]


@pytest.mark.parametrize("name", ["plain", "with blank", "A.b_c~d-9"])
def test_plain_paths_have_no_escape_but_blanks(name):
    assert is_plain(Path("/folder") / name)
    assert Path("/folder", name).as_uri().replace("%20", " ") == f"file:///folder/{name}"


@pytest.mark.parametrize("name", ODD)
def test_another_folder_is_taken(name, tmp_path, monkeypatch):
    (tmp_path / name).mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / name))
    assert is_plain(unpacking_folder())
    assert not is_plain(tmp_path / name)


def test_no_folder_is_one_sentence(tmp_path, monkeypatch):
    monkeypatch.setattr(places, "_candidates", lambda: iter([tmp_path / "größe"]))
    with pytest.raises(UserError, match=r"^FMUs cannot be unpacked into .*; set TMPDIR to such a folder$"):
        unpacking_folder()


def test_a_check_survives(tmp_path, demo_folder):
    odd = tmp_path / "größe#1"
    odd.mkdir()
    line = [sys.executable, "-m", "fmus", "check", "--groups", "L", str(demo_folder / "DemoSpring.fmu")]
    done = subprocess.run(line, env={**os.environ, "TMPDIR": str(odd)}, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
