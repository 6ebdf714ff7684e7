"""`run_groups`: apply the rules that run the FMU, in a process of their own, whatever becomes of that process."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import fmukit
from fmukit.archive import ArchiveError
from fmukit.conformance.bench import PLATFORM
from fmukit.conformance.errand import death
from fmukit.conformance.groups import FOUNDATION, RULES
from fmukit.conformance.package import Package
from fmukit.conformance.rule import Finding

PATIENCE = 30.0
_RULES = {rule.number: rule for rule in RULES}
_NUMBERS = list(_RULES)


def run_groups(
    subject: Package | Path | str, others: Sequence[Path | str] = (), patience: float = PATIENCE
) -> list[Finding]:
    """A finding per rule of the groups L, B and I, in their order.

    `others` are FMUs to run beside it. A rule that takes longer than `patience` [s] fails. The archive is unpacked with
    the limits of `fmukit.archive`; its code runs with the rights of the caller.
    """
    package = subject if isinstance(subject, Package) else Package.read(subject)
    reason = _unfit(package)
    if reason:
        return _skipped(_NUMBERS, reason)
    with tempfile.TemporaryDirectory(prefix="fmus-check-", ignore_cleanup_errors=True) as name:
        scratch = Path(name)
        try:
            arguments = [str(package.path.resolve()), _unpacked(package, scratch / "fmu")]
            beside = [Package.read(path) for path in others]
            extra = [
                text
                for k, other in enumerate(beside)
                if not _unfit(other)
                for text in (str(other.path.resolve()), _unpacked(other, scratch / f"other{k}"))
            ]
        except ArchiveError as error:
            return _skipped(_NUMBERS, str(error))
        return _all_rules(arguments, extra, scratch, patience)


def _unpacked(package: Package, folder: Path) -> str:
    package.unpack(folder)
    return str(folder)


def _unfit(package: Package) -> str:
    """Why the FMU cannot be run at all, or nothing."""
    if not package.readable or not package.identifier:
        return "the archive or its model description cannot be read as co-simulation FMU (see the groups A and X)"
    place, suffix = PLATFORM
    library = f"binaries/{place}/{package.identifier}{suffix}"
    return "" if library in package.names else f"it has no binary for this platform ({library})"


def _skipped(numbers: Sequence[str], reason: str) -> list[Finding]:
    return [Finding(_RULES[number], "skip", (reason,)) for number in numbers]


def _all_rules(arguments: list[str], others: list[str], scratch: Path, patience: float) -> list[Finding]:
    """Worker after worker, until every rule has its finding."""
    found: list[Finding] = []
    while len(found) < len(_NUMBERS):
        for finding in _one_worker([*arguments, _NUMBERS[len(found)], *others], scratch, patience):
            found.append(finding)
            number = finding.rule.number
            if number in FOUNDATION and finding.status == "fail":
                return found + _skipped(_NUMBERS[len(found) :], f"not looked at, because rule {number} does not hold")
    return found


def _one_worker(arguments: list[str], scratch: Path, patience: float) -> Iterator[Finding]:
    """The findings of one worker; its last one says how it died, if it did."""
    process = _start(arguments, scratch)
    events: queue.Queue[dict[str, Any] | None] = queue.Queue()
    threading.Thread(target=_listen, args=(process, events), daemon=True).start()
    at = arguments[2]
    try:
        while True:
            event = events.get(timeout=patience)
            if event is None:
                break
            at = event.get("begin", at)
            if "status" in event:
                yield Finding(_RULES[event["number"]], event["status"], tuple(event["seen"]))
                at = ""
        code = process.wait()
        if at:
            yield Finding(_RULES[at], "fail", (f"the process {death(code)}",))
    except queue.Empty:
        yield Finding(_RULES[at or arguments[2]], "fail", (f"no answer within {patience:g} s: a call does not return",))
    finally:
        process.kill()
        process.wait()


def _start(arguments: list[str], scratch: Path) -> subprocess.Popen[bytes]:
    """The worker, with folders of its own for work and for temporary files."""
    places = {name: scratch / name for name in ("work", "temporary")}
    for place in places.values():
        place.mkdir(exist_ok=True)
    environment = os.environ | dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(places["temporary"]))
    root = str(Path(fmukit.__file__).resolve().parents[1])
    environment["PYTHONPATH"] = os.pathsep.join([root, *filter(None, [os.environ.get("PYTHONPATH")])])
    return subprocess.Popen(
        [sys.executable, "-m", "fmukit.conformance.worker", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        stdin=subprocess.DEVNULL,
        cwd=places["work"],
        env=environment,
    )


def _listen(process: subprocess.Popen[bytes], events: queue.Queue[dict[str, Any] | None]) -> None:
    assert process.stdout is not None
    for line in process.stdout:
        events.put(json.loads(line))
    events.put(None)
