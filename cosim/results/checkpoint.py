"""Checkpoints as files: a zip archive with plain values as JSON, signals and FMU states as bytes."""

from __future__ import annotations

import io
import json
import os
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cosim.engine.moment import Moment
from cosim.errors import CosimError
from cosim.model.face import Value
from cosim.model.signals import Vector
from fmukit import files
from fmukit.errors import because

CHECKPOINT = "checkpoint.zip"
_FORMAT = 1


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """A moment of a run of which `rows` had been recorded; `asked` is the request, `models` the SHA-256 of its FMUs.

    The `digest` is that of the system: instances, periods, values, connections, faults.
    """

    moment: Moment
    rows: int
    asked: dict[str, Any]
    models: dict[str, str]
    digest: str


@dataclass(frozen=True, slots=True)
class Resumed:
    """A run goes on from `checkpoint`, with the rows `table` recorded before it; `changes` are values set first."""

    checkpoint: Checkpoint
    table: Any
    changes: Sequence[tuple[str, Value]] = ()


def write_checkpoint(kept: Checkpoint, folder: Path) -> None:
    """Replace the checkpoint in the folder at once; raises OSError."""
    moment, names = kept.moment, list(kept.moment.states)
    about = {
        "format": _FORMAT,
        "time": moment.time,
        "rows": kept.rows,
        "asked": kept.asked,
        "models": kept.models,
        "instances": names,
        "texts": list(moment.texts),
        "said": dict(moment.said),
        "acting": dict(moment.acting),
        "signals": list(moment.signals),
        "digest": kept.digest,
    }
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("about.json", json.dumps(about))
        archive.writestr("vector", moment.vector.tobytes())
        for k, name in enumerate(names):
            archive.writestr(f"held/{k}", moment.held[name].tobytes())
            archive.writestr(f"state/{k}", moment.states[name])
    files.write(folder / CHECKPOINT, buffer.getvalue())


def read_checkpoint(folder: Path) -> Checkpoint:
    """The checkpoint in the folder; raises CosimError when there is none, or none that is whole."""
    path = folder / CHECKPOINT
    try:
        with zipfile.ZipFile(io.BytesIO(path.read_bytes())) as archive:
            about = json.loads(archive.read("about.json"))
            if about["format"] != _FORMAT:
                raise CosimError(f"{path} is of another version of cosim; run with that one")
            numbered = list(enumerate(about["instances"]))
            moment = Moment(
                about["time"],
                _doubles(archive.read("vector")),
                about["texts"],
                {name: _doubles(archive.read(f"held/{k}")) for k, name in numbered},
                about["said"],
                about["acting"],
                {name: archive.read(f"state/{k}") for k, name in numbered},
                about["signals"],
            )
            return Checkpoint(moment, about["rows"], about["asked"], about["models"], about["digest"])
    except FileNotFoundError:
        raise CosimError(f"{folder} has no checkpoint; runs with --checkpoint leave one") from None
    except OSError as error:
        raise CosimError(f"{path} cannot be read: {because(error)}") from None
    except (zipfile.BadZipFile, KeyError, ValueError, TypeError, EOFError):
        raise CosimError(f"{path} is damaged; begin the run anew") from None


def _doubles(data: bytes) -> Vector:
    return np.frombuffer(data, np.float64).copy()


def absolute(path: str) -> str:
    """A path that means the same from any folder; names that are no paths stay."""
    return os.path.abspath(path) if os.path.exists(path) else path
