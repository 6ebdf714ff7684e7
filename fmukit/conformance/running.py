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
from fmukit.conformance.bench import PLATFORM, Bench
from fmukit.conformance.errand import death
from fmukit.conformance.package import Package
from fmukit.conformance.rule import Finding, Rule
from fmukit.conformance.rulebook import RUNNING
from fmukit.places import unpacking_folder
from fmukit.unpacking import ArchiveError

PATIENCE = 30.0
_BY_ID = {rule.id: rule for rule in RUNNING}


def run_groups(
    subject: Package | Path | str,
    others: Sequence[Path | str] = (),
    patience: float = PATIENCE,
    groups: str = "LBI",
) -> list[Finding]:
    """A finding per rule of those `groups`, in their order; vital rules of others are applied, but not reported.

    `others` are FMUs to run beside it. A rule that takes longer than `patience` [s] fails. The archive is unpacked with
    the limits of `fmukit.unpacking`; its code runs with the rights of the caller.
    """
    package = subject if isinstance(subject, Package) else Package.read(subject)
    wanted, reason = of_groups(groups), _unfit(package)
    if reason:
        return skipped(wanted, reason)
    with tempfile.TemporaryDirectory("", "fmus-check-", unpacking_folder(), ignore_cleanup_errors=True) as name:
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
            return skipped(wanted, str(error))
        rules = [rule for rule in RUNNING if rule.vital or rule in wanted]
        return [found for found in _all_rules(arguments, extra, rules, scratch, patience) if found.rule in wanted]


def of_groups(groups: str) -> list[Rule[Bench]]:
    """The rules for running FMUs of those groups."""
    return [rule for rule in RUNNING if rule.id[0] in groups]


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


def skipped(rules: Sequence[Rule[Bench]], reason: str) -> list[Finding]:
    """Findings that say why none of the rules was looked at."""
    return [Finding(rule, "skip", (reason,)) for rule in rules]


def _all_rules(
    arguments: list[str], others: list[str], rules: Sequence[Rule[Bench]], scratch: Path, patience: float
) -> list[Finding]:
    """Worker after worker, until every rule has its finding."""
    found: list[Finding] = []
    while len(found) < len(rules):
        left = [rule.id for rule in rules[len(found) :]]
        for finding in _one_worker([*arguments, ",".join(left), *others], left[0], scratch, patience):
            found.append(finding)
            rule = finding.rule
            if rule.vital and finding.status == "fail":
                return found + skipped(rules[len(found) :], f"not looked at, because rule {rule.id} does not hold")
    return found


def _one_worker(arguments: list[str], first: str, scratch: Path, patience: float) -> Iterator[Finding]:
    """The findings of one worker, from the rule `first` on; its last one says how it died, if it did."""
    process = _start(arguments, scratch)
    events: queue.Queue[dict[str, Any] | None] = queue.Queue()
    threading.Thread(target=_listen, args=(process, events), daemon=True).start()
    at = first
    try:
        while True:
            event = events.get(timeout=patience)
            if event is None:
                break
            at = event.get("begin", at)
            if "status" in event:
                yield Finding(_BY_ID[event["rule"]], event["status"], tuple(event["seen"]))
                at = ""
        code = process.wait()
        if at:
            yield Finding(_BY_ID[at], "fail", (f"the process {death(code)}",))
    except queue.Empty:
        yield Finding(_BY_ID[at or first], "fail", (f"no answer within {patience:g} s: a call does not return",))
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
