"""Jobs for foreign hosts, the answers of our own master to them, and the processes the hosts run in."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from host_job import Job
from own_answer import Answer, Make, alone, ask, of_scenario

from cosim.engine.loader import Loader
from cosim.engine.models import find
from fmukit.hosting.environment import environment
from fmus import CATALOGUE

Answers = Callable[[str, Mapping[str, Job]], dict[str, Answer]]
STEP, STEPS, EVERY = 0.001, 4000, 10
PACKAGES = {"ecos": "ecospy", "libcosim": "libcosimpy", "fmpy": "fmpy", "pathsim": "pathsim_fmi"}
PACKAGES |= {"omsimulator": "OMSimulator"}


@pytest.fixture(scope="session")
def loop() -> Make:
    """The closed loop of the high-speed manoeuvre: seven FMUs."""
    return of_scenario("high-speed-tracking")


@pytest.fixture(scope="session")
def loop_job(loop: Make) -> Job:
    return ask(loop, STEP, STEPS, EVERY)[0]


@pytest.fixture(scope="session")
def loop_answer(loop: Make) -> Answer:
    """What our master makes of the closed loop with the scheme jacobi: [row, signal]."""
    return ask(loop, STEP, STEPS, EVERY)[1]


@pytest.fixture(scope="session")
def single_jobs(loop: Make) -> tuple[dict[str, Job], dict[str, Answer]]:
    """One job per FMU of the catalogue, alone, with the values it has in the loop, at its own step."""
    with Loader(find) as loader:
        made = loop(loader)
    values = {made.model(name): made.changed(name) for name in made.system.instances}
    jobs, answers = {}, {}
    for component in CATALOGUE:
        name = component.interface.name
        jobs[name], answers[name] = ask(alone(name, values.get(name, {})), component.interface.step, 30, 1)
    return jobs, answers


@pytest.fixture(scope="session")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    """answers("ecos", jobs): what a host makes of jobs, in a process of its own; skips what is not installed."""

    def run(host: str, jobs: Mapping[str, Job]) -> dict[str, Answer]:
        if find_spec(PACKAGES[host]) is None:
            pytest.skip(f"the package {PACKAGES[host]} is not installed; it has no wheel for this platform")
        folder = tmp_path_factory.mktemp(host)
        (folder / "jobs.json").write_text(json.dumps(jobs))
        script = Path(__file__).with_name(f"host_{host}.py")
        command = [sys.executable, str(script), str(folder / "jobs.json"), str(folder / "out.npz")]
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, env=environment(os.environ), timeout=300
        )
        assert done.returncode == 0, f"{done.returncode}: {done.stdout[-2000:]}{done.stderr[-2000:]}"
        with np.load(folder / "out.npz") as found:
            return dict(found)

    return run
