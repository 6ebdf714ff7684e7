"""Group A: the FMU as an archive. Nothing is unpacked to disk."""

from __future__ import annotations

from collections.abc import Iterator

from fmukit import unpacking
from fmukit.conformance.package import DESCRIPTION, Package
from fmukit.conformance.rule import NotApplicable, Rules

_PLACES = {DESCRIPTION, "model.png", "documentation", "sources", "binaries", "resources", "extra", "terminalsAndIcons"}


def contents(package: Package) -> str:
    """Why rules about the entries do not apply: they need a table of contents."""
    return "the archive cannot be read" if package.damage and not package.entries else ""


FILE: Rules[Package] = Rules()
ENTRIES: Rules[Package] = Rules(contents)


@FILE.add(
    "A1",
    "The file is a zip archive whose every entry can be read",
    "2.3",
    "Make the FMU again as an ordinary zip archive, unencrypted; a file cut short by a download must be fetched again.",
    vital=True,
)
def _readable(package: Package) -> Iterator[str]:
    if package.damage:
        yield package.damage
        return
    if any(unpacking.oversize(package.entries)) or any(unpacking.packed_otherwise(package.entries)):
        return  # reading it all is what a bomb waits for
    try:
        yield from unpacking.damaged(package.path)
    except Exception as error:  # zipfile raises many kinds, see fmukit.unpacking
        yield f"an entry cannot be read: {' '.join(str(error).split())}"


@ENTRIES.add(
    "A2",
    "Entries are deflated or stored",
    "2.3",
    "Pack the FMU with the method deflate, which is what `zip` and zipfile.ZIP_DEFLATED do.",
    vital=True,
)
def _methods(package: Package) -> Iterator[str]:
    yield from unpacking.packed_otherwise(package.entries)


@ENTRIES.add(
    "A3",
    "No entry leads out of the archive",
    "2.3",
    "Name entries relative to the root of the FMU, with forward slashes, without '..', drive letters or a leading '/'.",
    vital=True,
)
def _escapes(package: Package) -> Iterator[str]:
    for entry in package.entries:
        if unpacking.escapes(entry.filename):
            yield f"the entry {entry.filename!r} would be written outside the folder the FMU is unpacked into"
        elif unpacking.hides(entry):
            yield f"the entry {entry.orig_filename!r} has a zero in its name"


@ENTRIES.add(
    "A4",
    "Entries are files and folders, no links or devices",
    "good practice",
    "Put the file itself into the archive in place of a link to it (zip without -y).",
    vital=True,
)
def _special(package: Package) -> Iterator[str]:
    for entry in package.entries:
        if unpacking.is_special(entry):
            yield f"{entry.filename!r} is a symbolic link or device"


@ENTRIES.add(
    "A5",
    "No two entries have the same name",
    "good practice",
    "Keep one of the entries; names that differ only in capitals overwrite each other on Windows and macOS.",
    vital=True,
)
def _duplicates(package: Package) -> Iterator[str]:
    yield from (f"the archive {sentence}" for sentence in unpacking.duplicates(package.entries))


@ENTRIES.add(
    "A6",
    "The archive has a sane size",
    "good practice",
    f"Stay below {unpacking.MAX_ENTRIES} entries and {unpacking.MAX_BYTES >> 20} MiB unpacked, and leave out files of "
    "nothing but padding: an archive that unpacks to far more than it weighs is refused as a zip bomb.",
    vital=True,
)
def _size(package: Package) -> Iterator[str]:
    yield from (f"the archive {sentence}" for sentence in unpacking.oversize(package.entries))


@ENTRIES.add(
    "A7",
    f"{DESCRIPTION} lies at the root",
    "2.3",
    f"Zip the contents of the folder, not the folder itself: {DESCRIPTION} must be an entry of exactly this name.",
)
def _description(package: Package) -> Iterator[str]:
    if DESCRIPTION not in package.names:
        near = sorted(name for name in package.names if name.casefold().endswith(DESCRIPTION.casefold()))
        yield f"there is no {DESCRIPTION}" + (f", but {near[0]!r}" if near else "")


@ENTRIES.add(
    "A11",
    "Everything has its place",
    "good practice",
    "Move what the FMU needs at run time to resources/, and what belongs to a tool to extra/.",
)
def _places(package: Package) -> Iterator[str]:
    if DESCRIPTION not in package.names:
        raise NotApplicable(f"there is no {DESCRIPTION}")
    roots = {name.split("/")[0] for name in package.names if not unpacking.escapes(name)}
    yield from (f"{place!r} at the root is no file or folder of the standard" for place in sorted(roots - _PLACES))


@ENTRIES.add(
    "A12",
    "Documentation opens at index.html",
    "2.3",
    "Add documentation/index.html, the page a tool opens when its user asks for help.",
)
def _documentation(package: Package) -> Iterator[str]:
    inside = [name for name in package.names if name.startswith("documentation/") and name != "documentation/"]
    if not inside:
        raise NotApplicable("there is no documentation")
    if "documentation/index.html" not in inside:
        yield f"documentation has {', '.join(sorted(inside)[:3])}, but no index.html"


@ENTRIES.add(
    "A13",
    "Source files listed are there",
    "4.3.1",
    "Add the files to sources/, or take them off the list SourceFiles.",
)
def _sources(package: Package) -> Iterator[str]:
    for name in package.listed_sources:
        if f"sources/{name}" not in package.names:
            yield f"SourceFiles lists {name!r}, which is not in sources/"


@ENTRIES.add(
    "A17",
    "Entries have names that Windows can use",
    "good practice",
    'Avoid CON, PRN, AUX, NUL, COM1 to COM9, LPT1 to LPT9, < > " | ? *, and dots or blanks at the end of a name.',
)
def _windows_names(package: Package) -> Iterator[str]:
    for name in sorted(package.names):
        if unpacking.reserved(name):
            yield f"Windows has no file or folder {name!r}"


@ENTRIES.add(
    "A14",
    "A Python FMU carries the script it names",
    "good practice",
    "Build the FMU again: resources/slavemodule.txt must hold the stem of a script in resources/.",
    vital=True,
)
def _script(package: Package) -> Iterator[str]:
    if not package.python or package.damage:
        raise NotApplicable("the FMU is not made with PythonFMU")
    if "resources/slavemodule.txt" not in package.names:
        yield "there is no resources/slavemodule.txt, which names the script"
        return
    stem = package.head("resources/slavemodule.txt").decode("utf-8", "replace").strip()
    if f"resources/{stem}.py" not in package.names:
        yield f"resources/slavemodule.txt names the script {stem!r}, but there is no resources/{stem}.py"
