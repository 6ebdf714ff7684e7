"""The cross-check bundle of an FMU: inputs, reference outputs and settings, in the format of the FMI cross-check.

CSV files have a quoted header, no trailing separators and at most 1 MB.
"""

from __future__ import annotations

import textwrap
from collections.abc import Mapping

import numpy as np

from fmukit.errors import BuildError
from fmukit.packaging.page import NONE, needs
from fmukit.packaging.recording import Recording, shown

RELATIVE_TOLERANCE = 1e-6
_LARGEST = 1_000_000
_README = """{title}
{line}
{text}

{inputs}{name}_ref.csv   outputs at every communication point
{name}_ref.opt   start time, stop time, communication step, relative tolerance

Parameters keep their start values. The reference comes from the equations, evaluated by CasADi, and not from the FMU:
agreement is evidence. {needed}

In FMPy:

    fmpy simulate {name}.fmu {options}--output-interval {step:g} --stop-time {stop:g}
"""
_NOT_PYTHON = "A host that is not Python needs a Python 3 interpreter it can find."
_INPUTS = "{name}_in.csv    inputs; a row holds from its communication point until the next\n"


def bundle(name: str, recording: Recording, packages: Mapping[str, str] = NONE) -> dict[str, bytes]:
    """The files of the bundle by name; raises BuildError when a table is larger than the rules allow.

    `packages` are what the host's Python needs, with the least versions.
    """
    files = {f"{name}_ref.csv": table(recording.times, recording.outputs)}
    if recording.inputs:
        files[f"{name}_in.csv"] = table(recording.times, recording.inputs)
    for file, data in files.items():
        if len(data) > _LARGEST:
            raise BuildError(f"{file} has {len(data)} bytes, more than 1 MB; give the reference run a longer step")
    files[f"{name}_ref.opt"] = _options(recording).encode()
    files[f"{name}_readme.txt"] = _readme(name, recording, packages).encode()
    return files


def table(times: np.ndarray, columns: Mapping[str, np.ndarray]) -> bytes:
    """A CSV file of `times` and `columns`."""
    lines = [",".join(f'"{name}"' for name in ("time", *columns))]
    lines += [",".join(map(shown, row)) for row in np.column_stack([times, *columns.values()])]
    return ("\n".join(lines) + "\n").encode()


def _options(recording: Recording) -> str:
    run = recording.run
    entries = {"StartTime": 0.0, "StopTime": run.stop, "StepSize": run.step, "RelTol": RELATIVE_TOLERANCE}
    return "".join(f"{key},{value:g}\n" for key, value in entries.items())


def _readme(name: str, recording: Recording, packages: Mapping[str, str]) -> str:
    run, title = recording.run, f"{name}: cross-check bundle"
    return _README.format(
        title=title,
        line="=" * len(title),
        text=textwrap.fill(run.text, 118),
        inputs=_INPUTS.format(name=name) if recording.inputs else "",
        name=name,
        needed=f"The host needs {needs(packages)} it can find." if packages else _NOT_PYTHON,
        options=f"--input-file {name}_in.csv " if recording.inputs else "",
        step=run.step,
        stop=run.stop,
    )
