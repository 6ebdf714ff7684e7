"""Archives and descriptions that attack: the check ends with a finding, and unpacking stays in its folder."""

from __future__ import annotations

import random
import resource
from pathlib import Path

import pytest
from hostile_archives import ARCHIVES, Make, instead
from hostile_documents import DOCUMENTS
from raw_zip import Entry

from fmukit import unpacking
from fmukit.conformance.check import check
from fmukit.conformance.report import sentences
from fmukit.conformance.rule import Finding
from fmukit.conformance.rulebook import ALL, READING

_MEMORY = 600_000  # kB: descriptions of 12 MB are among them


def _document(what: str) -> Make:
    return instead(lambda entry: Entry(entry.name, DOCUMENTS[what](entry.data)))


HOSTILE: dict[str, Make] = {**ARCHIVES, **{f"description: {what}": _document(what) for what in DOCUMENTS}}


def survived(file: Path) -> list[Finding]:
    """The findings of groups A and X, in which no rule broke down, and which say something printable."""
    findings = check(file, "AX")
    assert [finding.rule for finding in findings] == list(READING)
    for finding in findings:
        assert all(len(seen) < 100_000 for seen in finding.seen)
        assert not any("Error: " in seen for seen in finding.seen), finding.seen
    assert sentences(file, findings, strict=True).isprintable() or "\n" in sentences(file, findings, strict=True)
    return findings


def unpacks_inside(file: Path) -> None:
    """Into its folder or not at all."""
    folder = file.parent / "deep" / "inside"
    folder.parent.mkdir()
    before = {path for path in file.parent.parent.rglob("*") if folder not in path.parents}
    try:
        unpacking.unpack(file, folder)
    except unpacking.ArchiveError as refusal:
        assert "\n" not in str(refusal)
    after = {path for path in file.parent.parent.rglob("*") if folder not in path.parents}
    assert after - before <= {folder}
    assert not Path("/tmp/slip").exists() and not Path("/slip").exists()


@pytest.mark.parametrize("what", HOSTILE)
def test_the_check_survives(what: str, good: Path, tmp_path: Path) -> None:
    (tmp_path / "around").mkdir()
    file = tmp_path / "around" / "hostile.fmu"
    HOSTILE[what](good, file)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    assert any(finding.status == "fail" for finding in survived(file)), "something must be said"
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < _MEMORY
    unpacks_inside(file)


@pytest.mark.parametrize("seed", range(60))
def test_damage_anywhere_is_survived(seed: int, good: Path, tmp_path: Path) -> None:
    """Some bytes of the archive changed, doubled or lost, near its headers and anywhere."""
    generator = random.Random(seed)
    data = bytearray(good.read_bytes())
    for _ in range(generator.choice((1, 3, 30))):
        spot = generator.choice((generator.randrange(len(data)), len(data) - 1 - generator.randrange(3000)))
        data[spot : spot + generator.choice((0, 1, 4))] = generator.randbytes(generator.choice((0, 1, 4)))
    (tmp_path / "around").mkdir()
    file = tmp_path / "around" / "damaged.fmu"
    file.write_bytes(bytes(data))
    survived(file)
    unpacks_inside(file)


@pytest.mark.parametrize("what", ["slip ../slip", "a link", "twice modelDescription.xml", "a bomb"])
def test_what_is_hostile_is_not_run(what: str, good: Path, tmp_path: Path) -> None:
    HOSTILE[what](good, tmp_path / "hostile.fmu")
    findings = check(tmp_path / "hostile.fmu")
    assert [finding.rule for finding in findings] == list(ALL)
    assert {finding.status for finding in findings if finding.rule.id[0] in "LBI"} == {"skip"}


def test_there_are_enough_of_them() -> None:
    assert len(HOSTILE) >= 150
