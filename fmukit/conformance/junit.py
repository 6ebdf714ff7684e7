"""The outcome of a check as JUnit XML, which build servers show."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from junitparser import Error, Failure, JUnitXml, Skipped, TestCase, TestSuite

from fmukit.conformance.report import printable, said
from fmukit.conformance.rule import Finding

Result = Error | Failure | Skipped


def write(file: Path, found: Iterable[tuple[Path, Sequence[Finding]]], *, strict: bool) -> None:
    """One suite per FMU, one case per rule; advice that is not followed is a failure only when `strict`.

    What is undecided is an error.

    Raises OSError.
    """
    report = JUnitXml("fmus check")
    for path, findings in found:
        suite = TestSuite(printable(str(path)))
        suite.add_testcases([_case(path, finding, strict) for finding in findings])
        report.add_testsuite(suite)
    report.update_statistics()  # type: ignore[no-untyped-call]
    report.write(str(file), pretty=True)


def _case(path: Path, finding: Finding, strict: bool) -> TestCase:
    rule = finding.rule
    case = TestCase(f"{rule.id} {rule.title}", f"{printable(path.stem)}.{rule.group}")
    text = "\n".join(said(finding))
    if finding.status == "undecided":
        case.result = [Error(printable(" ".join(finding.seen)), "undecided")]
    elif finding.fails(strict=strict):
        failure = Failure(rule.remedy, rule.severity)
        failure.text = text
        case.result = [failure]
    elif finding.is_broken("advice"):
        case.system_out = text
    elif finding.status == "skip":
        case.result = [Skipped(printable(" ".join(finding.seen)))]
    return case
