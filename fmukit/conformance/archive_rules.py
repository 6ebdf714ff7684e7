"""Group A: the FMU as an archive. Nothing is unpacked to disk."""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Iterator
from pathlib import PurePosixPath

from fmukit import archive
from fmukit.conformance.binary import is_library
from fmukit.conformance.package import DESCRIPTION, Package
from fmukit.conformance.rule import NotApplicable, Rules

Check = Callable[[Package], Iterator[str]]
ARCHIVE: Rules[Package] = Rules("A")
EXTENSIONS = {"win32": ".dll", "win64": ".dll", "linux32": ".so", "linux64": ".so", "darwin64": ".dylib"}
_PLACES = {DESCRIPTION, "model.png", "documentation", "sources", "binaries", "resources", "extra", "terminalsAndIcons"}


def _rule(title: str, section: str, remedy: str) -> Callable[[Check], Check]:
    """A rule about the entries; it does not apply where there is no table of contents."""

    def register(check: Check) -> Check:
        def guarded(package: Package) -> Iterator[str]:
            if package.damage and not package.entries:
                raise NotApplicable("the archive cannot be read")
            yield from check(package)

        ARCHIVE.add(title, section, remedy)(guarded)
        return check

    return register


@ARCHIVE.add(
    "The file is a zip archive whose every entry can be read",
    "2.3",
    "Make the FMU again as an ordinary zip archive, unencrypted; a file cut short by a download must be fetched again.",
)
def _readable(package: Package) -> Iterator[str]:
    if package.damage:
        yield package.damage
        return
    if any(archive.oversize(package.entries)) or any(archive.packed_otherwise(package.entries)):
        return  # reading it all is what a bomb waits for
    try:
        with zipfile.ZipFile(package.path) as zipped:
            damaged = zipped.testzip()
    except Exception as error:  # zipfile raises many kinds, see fmukit.archive
        yield f"an entry cannot be read: {' '.join(str(error).split())}"
        return
    if damaged is not None:
        yield f"the entry {damaged!r} does not match its checksum"


@_rule(
    "Entries are deflated or stored",
    "2.3",
    "Pack the FMU with the method deflate, which is what `zip` and zipfile.ZIP_DEFLATED do.",
)
def _methods(package: Package) -> Iterator[str]:
    yield from archive.packed_otherwise(package.entries)


@_rule(
    "No entry leads out of the archive",
    "2.3",
    "Name entries relative to the root of the FMU, with forward slashes, without '..', drive letters or a leading '/'.",
)
def _escapes(package: Package) -> Iterator[str]:
    for entry in package.entries:
        if archive.escapes(entry.filename):
            yield f"the entry {entry.filename!r} would be written outside the folder the FMU is unpacked into"


@_rule(
    "Entries are files and folders, no links or devices",
    "good practice",
    "Put the file itself into the archive in place of a link to it (zip without -y).",
)
def _special(package: Package) -> Iterator[str]:
    for entry in package.entries:
        if archive.is_special(entry):
            yield f"{entry.filename!r} is a symbolic link or device"


@_rule(
    "No two entries have the same name",
    "good practice",
    "Keep one of the entries; names that differ only in capitals overwrite each other on Windows and macOS.",
)
def _duplicates(package: Package) -> Iterator[str]:
    yield from (f"the archive {sentence}" for sentence in archive.duplicates(package.entries))


@_rule(
    "The archive has a sane size",
    "good practice",
    f"Stay below {archive.MAX_ENTRIES} entries and {archive.MAX_BYTES >> 20} MiB unpacked, and leave out files of "
    "nothing but padding: an archive that unpacks to far more than it weighs is refused as a zip bomb.",
)
def _size(package: Package) -> Iterator[str]:
    yield from (f"the archive {sentence}" for sentence in archive.oversize(package.entries))


@_rule(
    f"{DESCRIPTION} lies at the root",
    "2.3",
    f"Zip the contents of the folder, not the folder itself: {DESCRIPTION} must be an entry of exactly this name.",
)
def _description(package: Package) -> Iterator[str]:
    if DESCRIPTION not in package.names:
        near = sorted(name for name in package.names if name.casefold().endswith(DESCRIPTION.casefold()))
        yield f"there is no {DESCRIPTION}" + (f", but {near[0]!r}" if near else "")


@_rule(
    "There is a binary for at least one platform of the standard",
    "2.3",
    f"Put the library into binaries/ under one of {', '.join(EXTENSIONS)}, or ship sources/ and list them.",
)
def _platforms(package: Package) -> Iterator[str]:
    if not _libraries(package) and not _listed_sources(package):
        found = sorted({"/".join(PurePosixPath(name).parts[:2]) for name in package.names if name.startswith("bin")})
        yield f"no binaries for any of {', '.join(EXTENSIONS)}; there is {', '.join(found) or 'no folder binaries'}"


@_rule(
    "Every platform has a library named after modelIdentifier",
    "2.3",
    "Rename the library, or modelIdentifier in the description, so that both are the same.",
)
def _library_name(package: Package) -> Iterator[str]:
    if not package.identifier:
        raise NotApplicable("the description gives no modelIdentifier")
    for platform, names in _libraries(package).items():
        wanted = f"binaries/{platform}/{package.identifier}{EXTENSIONS[platform]}"
        if wanted not in names:
            yield f"there is no {wanted}; the folder has {', '.join(PurePosixPath(name).name for name in names)}"


@_rule(
    "Libraries are made for the platform whose folder they lie in",
    "2.3",
    "Compile the library for the platform of its folder (cross-compiled files are easily mixed up).",
)
def _library_format(package: Package) -> Iterator[str]:
    if package.damage:
        raise NotApplicable("the archive is damaged")
    for platform, names in _libraries(package).items():
        name = f"binaries/{platform}/{package.identifier}{EXTENSIONS[platform]}"
        if name in names and (head := _head(package, name)) and not is_library(head, platform):
            yield f"{name} is not a {platform} library"


@_rule(
    "Everything has its place",
    "good practice",
    "Move what the FMU needs at run time to resources/, and what belongs to a tool to extra/.",
)
def _places(package: Package) -> Iterator[str]:
    if DESCRIPTION not in package.names:
        raise NotApplicable(f"there is no {DESCRIPTION}")
    roots = {name.split("/")[0] for name in package.names if not archive.escapes(name)}
    yield from (f"{place!r} at the root is no file or folder of the standard" for place in sorted(roots - _PLACES))


@_rule(
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


@_rule(
    "Source files listed are there",
    "4.3.1",
    "Add the files to sources/, or take them off the list SourceFiles.",
)
def _sources(package: Package) -> Iterator[str]:
    for name in _listed_sources(package):
        if f"sources/{name}" not in package.names:
            yield f"SourceFiles lists {name!r}, which is not in sources/"


@_rule(
    "A Python FMU carries the script it names",
    "good practice",
    "Build the FMU again: resources/slavemodule.txt must hold the stem of a script in resources/.",
)
def _script(package: Package) -> Iterator[str]:
    if not package.python or package.damage:
        raise NotApplicable("the FMU is not made with PythonFMU")
    if "resources/slavemodule.txt" not in package.names:
        yield "there is no resources/slavemodule.txt, which names the script"
        return
    stem = _head(package, "resources/slavemodule.txt").decode("utf-8", "replace").strip()
    if f"resources/{stem}.py" not in package.names:
        yield f"resources/slavemodule.txt names the script {stem!r}, but there is no resources/{stem}.py"


def _libraries(package: Package) -> dict[str, list[str]]:
    """Files of each platform of the standard that has any."""
    folders = {
        platform: sorted(n for n in package.names if n.startswith(f"binaries/{platform}/") and n[-1] != "/")
        for platform in EXTENSIONS
    }
    return {platform: names for platform, names in folders.items() if names}


def _listed_sources(package: Package) -> list[str]:
    if package.cosimulation is None:
        return []
    return [str(file.get("name")) for file in package.cosimulation.iterfind("SourceFiles/File")]


def _head(package: Package, name: str, most: int = 4096) -> bytes:
    """The first bytes of an entry; none if it cannot be read, which the first rule tells."""
    try:
        with zipfile.ZipFile(package.path) as zipped, zipped.open(name) as source:
            return source.read(most)
    except Exception:  # zipfile raises many kinds, see fmukit.archive
        return b""
