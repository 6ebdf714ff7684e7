"""Every rule of the running FMU holds for the catalogue, and many lives leave next to nothing behind."""

from __future__ import annotations

import json
import subprocess
import sys
from time import monotonic

import pytest

from fmukit.build.cache import cached
from fmukit.component import Component
from fmukit.conformance.running import run_groups
from fmus import CATALOGUE, vehicle16dof
from fmus.controllers import reference
from fmus.sensors import gps

FEW = (vehicle16dof.COMPONENT, gps.COMPONENT, reference.COMPONENT)
_LIVES = """
import json, sys, tempfile
from pathlib import Path

from fmukit.conformance.bench import Bench
from fmukit.conformance.growth_rules import WARM_UP, measure, use
from fmukit.conformance.package import Package

package = Package.read(sys.argv[1])
with tempfile.TemporaryDirectory() as name:
    tempfile.tempdir = name
    package.unpack(Path(name) / "fmu")
    bench = Bench(package, Path(name) / "fmu")
    use(bench, WARM_UP)
    before = measure(bench)
    done = use(bench, 2000, patience=300.0)
    after = measure(bench)
    print(json.dumps({"lives": done, **{what: after[what] - before[what] for what in before}}))
"""


def _all_hold(component: Component) -> None:
    began = monotonic()
    findings = run_groups(cached(component))
    assert [(f.rule.number, f.rule.title, f.seen) for f in findings if f.status == "fail"] == []
    assert sum(finding.status == "pass" for finding in findings) >= 33
    assert monotonic() - began < 20.0


@pytest.mark.parametrize("component", FEW, ids=lambda component: component.interface.name)
def test_every_rule_holds(component: Component) -> None:
    _all_hold(component)


@pytest.mark.nightly
@pytest.mark.parametrize("component", [c for c in CATALOGUE if c not in FEW], ids=lambda c: c.interface.name)
def test_every_rule_holds_for_the_others(component: Component) -> None:
    _all_hold(component)


@pytest.mark.nightly
def test_the_whole_catalogue_side_by_side_takes_less_than_four_minutes() -> None:
    files = [cached(component) for component in CATALOGUE]
    began = monotonic()
    for k, file in enumerate(files, start=1):
        failed = [(f.rule.number, f.seen) for f in run_groups(file, files[k:]) if f.status == "fail"]
        assert failed == [], file.name
    assert monotonic() - began < 240.0


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="memory of a process is measured on Linux only")
def test_2000_lives_leave_less_than_2_kb_each() -> None:
    """What is left are leaks inside PythonFMU's binary."""
    file = str(cached(vehicle16dof.COMPONENT))
    done = subprocess.run([sys.executable, "-c", _LIVES, file], capture_output=True, text=True, check=True)
    grown = json.loads(done.stdout)
    assert grown["lives"] == 2000
    assert grown["memory"] < 2048 * 2000
    assert {what: grown[what] for what in ("path", "handles", "threads", "files")} == dict.fromkeys(
        ("path", "handles", "threads", "files"), 0
    )
