"""From an SSP, an SSD or the folder of one to what a run needs: `cosim run FILE.ssp`. docs/ssp.md says what is read."""

from __future__ import annotations

import logging
import math
from pathlib import Path

from cosim.errors import CosimError
from cosim.model.face import Face, read_face
from cosim.scenario.described import Description
from cosim.ssp.annotations import annotated
from cosim.ssp.document import Element
from cosim.ssp.flattening import flattened
from cosim.ssp.namespaces import SSD
from cosim.ssp.places import DEFAULT, Archives, Folder
from cosim.ssp.tree import Description as Ssd
from cosim.ssp.tree import Reader, described
from fmukit.unpacking import ArchiveError, read_member

_LOG = logging.getLogger("cosim")
_END = 1.0  # [s] of a run whose file names no end


def read_ssp(path: Path, temporary: Path) -> Description:
    """What the SSP, SSD or folder `path` describes; what it packs is unpacked into the folder `temporary`.

    `path` may end with # and the name of another SSD of an SSP. Raises CosimError for what cannot be read or run.
    """
    try:
        return _read(path, temporary)
    except RecursionError:
        raise CosimError(f"the systems of {path} are nested too deep to be read; flatten some of them") from None


def _read(path: Path, temporary: Path) -> Description:
    reader = Reader(Archives(temporary / "archives"))
    ssd, name = _opened(path, reader)
    root = reader.root(ssd)
    numbered = enumerate(reader.models.items())
    faces = {model: _face(model, file, temporary / "faces" / str(n)) for n, (model, file) in numbered}
    told = annotated(ssd.root.find(f"{{{SSD}}}System"), ssd.file)
    system = flattened(root, faces, told)
    system.files = dict(reader.models)
    stop = _stop(ssd.root, ssd.file)
    return Description(name, ssd.root.get("name") or name, system, stop, told.record_every, told.unrecorded)


def _opened(path: Path, reader: Reader) -> tuple[Ssd, str]:
    """The description to read, and what it is called."""
    if path.is_dir():
        file = _only(path)
        return described(file, Folder(path), ((file, ""),)), path.resolve().name
    plain, _, variant = str(path).partition("#") if not path.exists() else (str(path), "", "")
    file = Path(plain)
    if not file.is_file():
        raise CosimError(f"there is no file {file}")
    if file.suffix.lower() == ".ssp":
        return reader.package(file, file.name, variant, ((file, variant),)), Path(variant or file).stem
    return described(file, Folder(file.parent), ((file, ""),)), file.stem


def _only(folder: Path) -> Path:
    """The description of an unpacked SSP."""
    found = sorted(folder.glob("*.ssd"))
    if folder / DEFAULT in found:
        return folder / DEFAULT
    if len(found) != 1:
        raise CosimError(f"{folder} has no {DEFAULT}, and {len(found)} other .ssd files; name the file")
    return found[0]


def _face(model: str, file: Path, folder: Path) -> Face:
    """The face of an FMU, of which nothing but its description is unpacked."""
    try:
        data = read_member(file, "modelDescription.xml")
    except ArchiveError as error:
        raise CosimError(str(error).replace(str(file), model)) from None
    folder.mkdir(parents=True)
    (folder / "modelDescription.xml").write_bytes(data)
    return read_face(folder, Path(model))


def _stop(root: Element, file: str) -> float:
    """How long the default experiment takes [s]."""
    experiment = root.find(f"{{{SSD}}}DefaultExperiment")
    said = {} if experiment is None else {key: float(text) for key, text in experiment.attrib.items()}
    if not all(map(math.isfinite, said.values())):
        raise CosimError(f"{file}: the times of the default experiment must be finite numbers")
    start, stop = said.get("startTime", 0.0), said.get("stopTime")
    if stop is None:
        _LOG.info("%s says no end of the run: it ends at %g s, unless --stop-time gives another", file, _END)
        return _END
    if stop <= start:
        raise CosimError(f"{file}: the default experiment ends at {stop:g} s, not after its start at {start:g} s")
    if start:
        said_ = "%s: its default experiment starts at %g s; runs start at 0 s, so this one ends at %g s"
        _LOG.warning(said_, file, start, stop - start)
    return stop - start
