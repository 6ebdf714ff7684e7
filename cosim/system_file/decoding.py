"""TOML files of a given form, with the place of a mistake in one sentence."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any, TypeVar

import msgspec

from cosim.errors import CosimError
from fmukit.errors import because

Form = TypeVar("Form", bound=msgspec.Struct)


def read_toml(file: Path) -> dict[str, Any]:
    """What the file holds; raises CosimError."""
    try:
        return tomllib.loads(file.read_text("utf-8-sig"))
    except OSError as error:
        raise CosimError(f"{file} cannot be read: {because(error)}") from None
    except UnicodeDecodeError:
        raise CosimError(f"{file} is not a text in UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise CosimError(f"{file} is no TOML: {error}") from None


def read_form(file: Path, form: type[Form]) -> Form:
    """What the file holds, in its form; raises CosimError."""
    try:
        return msgspec.convert(read_toml(file), form)
    except msgspec.ValidationError as error:
        raise CosimError(f"{file}: {_plain(str(error))}") from None


def _plain(error: str) -> str:
    """The sentence of the library in the words of the page on system files."""
    place = re.search(r" - at `(key in )?\$\.?(.*?)`$", error)
    said = error[: place.start()] if place else error
    said = said.replace("Object contains unknown field", "unknown key").replace("Object missing required field", "no")
    said = said[:1].lower() + said[1:]
    return f"{said}, in {place[2].replace('[...]', ' ...')}" if place and place[2] else said
