"""Every rule of the running FMU holds for the catalogue, and many lives leave next to nothing behind."""

from __future__ import annotations

import json
import subprocess
import sys
from time import monotonic

import pytest

from fmukit.component import Component
from fmukit.conformance.running import run_groups
from fmukit.packaging.cached import cached
from fmus import CATALOGUE, vehicle16dof

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


@pytest.mark.parametrize("component", CATALOGUE, ids=lambda component: component.interface.name)
def test_every_rule_holds(component: Component) -> None:
    findings = run_groups(cached(component))
    assert [(f.rule.id, f.rule.title, f.seen) for f in findings if f.status == "fail"] == []
    assert sum(finding.status == "pass" for finding in findings) >= 33


@pytest.mark.nightly
@pytest.mark.parametrize(("count", "seconds"), [(1, 20.0), (len(CATALOGUE), 240.0)])
def test_time_of_the_command(count: int, seconds: float) -> None:
    """One FMU within 20 s; the catalogue, each FMU in the company of the others, within 4 minutes."""
    files = [str(cached(component)) for component in CATALOGUE[:count]]
    began = monotonic()
    done = subprocess.run([sys.executable, "-m", "fmus", "check", *files], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert monotonic() - began < seconds


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
