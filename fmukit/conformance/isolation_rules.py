"""Rules of isolation: an FMU runs on what it brings, whatever else lives in the process."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from shutil import copytree

from fmukit.conformance import errand
from fmukit.conformance.bare import host
from fmukit.conformance.bench import Bench
from fmukit.conformance.lifecycle_rules import disturbed_by_another
from fmukit.conformance.rule import NotApplicable, Rules
from fmukit.conformance.stranger import namesakes, stranger
from fmukit.places import unpacking_folder

RULES: Rules[Bench] = Rules()


@RULES.add(
    "I1",
    "It needs no packages of the host",
    "good practice",
    "embed what the FMU imports, or name the packages it needs in resources/requirements.txt",
)
def no_host_packages(bench: Bench) -> Iterator[str]:
    _python_only(bench)
    needs = requirements(bench)
    if needs:
        raise NotApplicable(f"resources/requirements.txt asks for {', '.join(needs)}")
    reference = bench.alone()
    try:
        rows = errand.send([bench.task()], bare=True)[0][0]
    except host.CallFailed as error:
        yield f"in a Python without any packages it does not run: {error}"
        return
    changed = bench.difference(rows, reference)
    if changed:
        yield f"in a Python without any packages its numbers differ: {changed}"


@RULES.add(
    "I2",
    "A copy and other FMUs in the process change nothing, in any order",
    "good practice",
    "give embedded modules names no other FMU has (a content hash), import them relatively, keep no global data",
)
def any_order(bench: Bench) -> Iterator[str]:
    if bench.package.flag("canBeInstantiatedOnlyOncePerProcess"):
        raise NotApplicable("canBeInstantiatedOnlyOncePerProcess is declared")
    bench.reference()
    if disturbed_by_another(bench):
        raise NotApplicable("two instances of this FMU disturb each other already")
    copy = _copy(bench)
    alone = {id(bench): bench.alone(), id(copy): bench.alone()} | {id(o): o.alone() for o in bench.others}
    sequences = [[[bench], [copy], [bench, copy]], [[copy, bench], [bench]]]
    for other in bench.others:
        sequences += [[[bench], [other], [bench, other]], [[other], [bench], [other, bench]]]
    for sequence in sequences:
        yield from _in_company(sequence, alone)


def _in_company(sequence: list[list[Bench]], alone: dict[int, list[host.Row]]) -> Iterator[str]:
    """Run them in one process of their own and compare each with its run alone."""
    words = ", ".join(" beside ".join(bench.package.identifier for bench in together) for together in sequence)
    try:
        results = errand.send([errand.lives([(b.target, b.experiment) for b in together]) for together in sequence])
    except host.CallFailed as error:
        yield f"run in one process in the order {words}: {error}"
        return
    for together, runs in zip(sequence, results, strict=True):
        for bench, rows in zip(together, runs, strict=True):
            changed = bench.difference(rows, alone[id(bench)])
            if changed:
                yield f"run in one process in the order {words}, {bench.package.identifier} differs: {changed}"


@RULES.add(
    "I3",
    "Modules of the same names in another FMU or in the host change nothing",
    "good practice",
    "put the embedded modules into a package whose name carries a content hash, and import them relatively",
)
def same_names(bench: Bench) -> Iterator[str]:
    _python_only(bench)
    names = namesakes(bench)
    if not names:
        return
    reference = bench.alone()
    with tempfile.TemporaryDirectory(dir=unpacking_folder()) as folder:
        other = stranger(bench, Path(folder), names)
        tasks = [errand.lives([(other, replace(bench.experiment, rows=((), ())))]), bench.task()]
        words = f"after another FMU that embeds modules named {', '.join(names)}"
        try:
            rows = errand.send(tasks)[1][0]
        except host.CallFailed as error:
            yield f"{words} it does not run: {error}"
            return
    changed = bench.difference(rows, reference)
    if changed:
        yield f"{words} its numbers differ: {changed}"


@RULES.add(
    "I4",
    "It writes on no descriptors of the host",
    "good practice",
    "write only on descriptors the FMU has opened itself, and to the logger of the host",
)
def foreign_descriptors(_bench: Bench) -> Iterator[str]:
    yield from ()  # `running` judges this rule, since no process in which the FMU runs can be trusted with it


CHANNEL = foreign_descriptors


def requirements(bench: Bench) -> list[str]:
    """The packages a Python FMU asks the host for."""
    path = bench.folder / "resources" / "requirements.txt"
    lines = path.read_text("utf-8", "replace").splitlines() if path.is_file() else []
    return [line.strip() for line in lines if line.strip() and not line.strip().startswith("#")]


def _copy(bench: Bench) -> Bench:
    folder = Path(tempfile.mkdtemp(prefix="copy-", dir=unpacking_folder())) / "fmu"
    copytree(bench.folder, folder)
    return Bench(bench.package, folder)


def _python_only(bench: Bench) -> None:
    if not bench.package.python:
        raise NotApplicable("it is not made with PythonFMU")
