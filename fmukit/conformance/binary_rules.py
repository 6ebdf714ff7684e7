"""Group A, continued: the libraries in the archive."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from fmukit.conformance.archive_rules import contents
from fmukit.conformance.binary import USUAL, library, missing
from fmukit.conformance.package import Package
from fmukit.conformance.rule import NotApplicable, Rules

RULES: Rules[Package] = Rules(contents)
EXTENSIONS = {"win32": ".dll", "win64": ".dll", "linux32": ".so", "linux64": ".so", "darwin64": ".dylib"}
_LOADED = (".dll", ".so")


@RULES.add(
    "A8",
    "There is a binary for at least one platform of the standard",
    "2.3",
    f"Put the library into binaries/ under one of {', '.join(EXTENSIONS)}, or ship sources/ and list them.",
)
def _platforms(package: Package) -> Iterator[str]:
    if not _libraries(package) and not package.listed_sources:
        found = sorted({"/".join(PurePosixPath(name).parts[:2]) for name in package.names if name.startswith("bin")})
        yield f"no binaries for any of {', '.join(EXTENSIONS)}; there is {', '.join(found) or 'no folder binaries'}"


@RULES.add(
    "A9",
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


@RULES.add(
    "A10",
    "Libraries are made for the platform whose folder they lie in",
    "2.3",
    "Compile the library for the platform of its folder (cross-compiled files are easily mixed up).",
)
def _library_format(package: Package) -> Iterator[str]:
    if package.damage:
        raise NotApplicable("the archive is damaged")
    for platform, name in _named(package):
        if package.size(name) == 0:
            yield f"{name} is empty"
        elif (head := package.head(name)) and library(head).platform != platform:
            yield f"{name} is not a {platform} library"


@RULES.add(
    "A16",
    "Libraries are made for the processor that the name of their folder stands for",
    "good practice",
    "Compile for x86 (win32, linux32) or x86_64 (win64, linux64): tools take these names for nothing else.",
)
def _library_processor(package: Package) -> Iterator[str]:
    if package.damage:
        raise NotApplicable("the archive is damaged")
    for platform, name in _named(package):
        found = library(package.head(name))
        if found.platform == platform and found.processor != USUAL.get(platform, found.processor):
            yield f"{name} is made for {found.processor}"


def _named(package: Package) -> Iterator[tuple[str, str]]:
    """Each platform and its library, as far as they are there."""
    for platform, names in _libraries(package).items():
        name = f"binaries/{platform}/{package.identifier}{EXTENSIONS[platform]}"
        if name in names:
            yield platform, name


@RULES.add(
    "A15",
    "Libraries are whole",
    "good practice",
    "Copy the library again and pack the FMU anew: a library cut short ends the process that loads it.",
    vital=True,
)
def _whole(package: Package) -> Iterator[str]:
    if package.damage:
        raise NotApplicable("the archive is damaged")
    for entry in package.entries:
        if entry.filename.endswith(_LOADED):
            lacking = missing(package.head(entry.filename), entry.file_size)
            if lacking:
                yield f"{entry.filename} has {entry.file_size} bytes and lacks {lacking} of those its header tells of"


def _libraries(package: Package) -> dict[str, list[str]]:
    """Files of each platform of the standard that has any."""
    folders = {
        platform: sorted(n for n in package.names if n.startswith(f"binaries/{platform}/") and n[-1] != "/")
        for platform in EXTENSIONS
    }
    return {platform: names for platform, names in folders.items() if names}
