"""`run_groups`: apply the rules that run the FMU, in a process of their own, whatever becomes of that process."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import monotonic

from fmukit.conformance.attendant import Attendant
from fmukit.conformance.bench import PLATFORM, Bench
from fmukit.conformance.deadline import Deadline
from fmukit.conformance.isolation_rules import CHANNEL
from fmukit.conformance.package import Package
from fmukit.conformance.rule import Finding, Rule
from fmukit.conformance.rulebook import RUNNING
from fmukit.places import unpacking_folder
from fmukit.scratch import scratch
from fmukit.unpacking import ArchiveError

DEADLINE = Deadline()


def run_groups(
    subject: Package | Path | str,
    others: Sequence[Path | str] = (),
    deadline: Deadline = DEADLINE,
    groups: str = "LBI",
) -> list[Finding]:
    """A finding per rule of those `groups`, in their order; vital rules of others are applied, but not reported.

    `others` are FMUs to run beside it. The archive is unpacked with the limits of `fmukit.unpacking`; its code runs
    with the rights of the caller, under guard (`fmukit.guard`) and within the `deadline`.
    """
    package = subject if isinstance(subject, Package) else Package.read(subject)
    wanted, reason = of_groups(groups), _unfit(package)
    if reason:
        return skipped(wanted, reason)
    beside = [other for other in map(Package.read, others) if not _unfit(other)]
    with scratch("fmus-check-", unpacking_folder()) as folder:
        rules = [rule for rule in RUNNING if rule.vital or rule in wanted]
        try:
            found = _Inspection((package, *beside), folder, deadline).findings(rules)
        except ArchiveError as error:
            return skipped(wanted, str(error))
    return [finding for finding in found if finding.rule in wanted]


def of_groups(groups: str) -> list[Rule[Bench]]:
    """The rules for running FMUs of those groups."""
    return [rule for rule in RUNNING if rule.id[0] in groups]


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


@dataclass(frozen=True)
class _Inspection:
    """The first of the FMUs is looked at, beside the others."""

    packages: tuple[Package, ...]
    scratch: Path
    deadline: Deadline

    def findings(self, rules: Sequence[Rule[Bench]]) -> list[Finding]:
        """One per rule, from worker after worker: who ends a worker does not end the check."""
        until = monotonic() + self.deadline.check
        found: list[Finding] = []
        strays: list[str] = []
        while len(found) < len(rules):
            if monotonic() > until:
                reason = f"the whole check was given {self.deadline.check:g} s, which are over"
                found += [Finding(rule, "undecided", (reason,)) for rule in rules[len(found) :]]
                break
            with Attendant(self._unpacked(), self.scratch, self.deadline, until) as worker:
                while worker.alive and len(found) < len(rules):
                    found.append(worker.ask(rules[len(found)]))
                    broken = _foundation_lost(found[-1])
                    if broken:
                        found += skipped(rules[len(found) :], broken)
                strays += worker.strays
        return [_strayed(finding, strays) for finding in found]

    def _unpacked(self) -> list[str]:
        """Each FMU and the folder it is unpacked in, afresh for every worker: an FMU may have spoilt its own."""
        arguments = []
        for package in self.packages:
            folder = Path(tempfile.mkdtemp(prefix="unpacked-", dir=self.scratch)) / "fmu"
            package.unpack(folder)
            arguments += [str(package.path.resolve()), str(folder)]
        return arguments


def _foundation_lost(finding: Finding) -> str:
    """Why the rules that come after are not looked at, or nothing."""
    if not finding.rule.vital or finding.status in ("pass", "skip"):
        return ""
    what = "does not hold" if finding.status == "fail" else "is undecided"
    return f"not looked at, because rule {finding.rule.id} {what}"


def _strayed(finding: Finding, strays: Sequence[str]) -> Finding:
    """The rule on the channel of answers is judged by who listened to it."""
    if finding.rule.check is not CHANNEL or not strays:
        return finding
    seen = f"{len(strays)} lines that are no answers of the checker stood in its channel, such as {strays[0]}"
    return replace(finding, status="fail", seen=(seen,))
