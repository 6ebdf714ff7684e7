"""Small FMUs compiled from one C file each, and Python FMUs with one member of their archive changed."""

from __future__ import annotations

import re
import subprocess
import zipfile
from collections.abc import Callable
from pathlib import Path

SOURCES = Path(__file__).parent / "broken_running"
_FIRST_LINE = re.compile(r"/\* (\w+): (.*) \*/")
_DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Sound" guid="{{5a0f6f0e-6d55-4a44-9f0b-3b1f4c9f2d11}}"
    generationDateAndTime="2024-01-01T00:00:00Z">
  <CoSimulation modelIdentifier="sound" canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true"
      canSerializeFMUstate="true"/>
  <UnitDefinitions><Unit name="1"><BaseUnit/></Unit></UnitDefinitions>
  <DefaultExperiment startTime="0" stopTime="1" stepSize="0.01"/>
  <ModelVariables>
    <ScalarVariable name="gain" valueReference="0" causality="parameter" variability="fixed" initial="exact">
      <Real start="2" min="0.1" max="10" unit="1"/></ScalarVariable>
    <ScalarVariable name="u" valueReference="1" causality="input" variability="{kind}">
      <Real start="0" min="-10" max="10" unit="1"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output" variability="{kind}" initial="calculated">
      <Real unit="1"/></ScalarVariable>
    <ScalarVariable name="label" valueReference="0" causality="parameter" variability="fixed" initial="exact">
      <String start=""/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="3" dependencies=""/></Outputs>
    <InitialUnknowns><Unknown index="3" dependencies=""/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""


def breaks(source: Path) -> str:
    """The name of the check that must fail, from the first line of the source."""
    found = _FIRST_LINE.match(source.read_text("utf-8"))
    assert found, f"{source.name} does not begin with the rule it breaks"
    return found[1]


def compiled(source: Path, folder: Path) -> Path:
    """The FMU of a C file of `broken_running`, in `folder`."""
    library, file = folder / f"{source.stem}.so", folder / f"{source.stem}.fmu"
    options = ["-std=gnu11", "-O1", "-w", "-shared", "-fPIC", "-fvisibility=hidden", "-pthread"]
    subprocess.run(["cc", *options, "-o", str(library), str(source), "-lm"], check=True)
    kind = "continuous" if "define CONTINUOUS" in source.read_text("utf-8") else "discrete"
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", _DESCRIPTION.format(kind=kind))
        archive.write(library, "binaries/linux64/sound.so")
    return file


def changed(original: Path, file: Path, member: str, change: Callable[[str], str], **more: str) -> Path:
    """A copy of an FMU with the member that matches `member` changed, and `more` modules in its resources."""
    with zipfile.ZipFile(original) as old, zipfile.ZipFile(file, "w") as new:
        (name,) = (name for name in old.namelist() if re.fullmatch(f".*/{member}", name))
        for entry in old.namelist():
            data = old.read(entry)
            new.writestr(entry, change(data.decode()).encode() if entry == name else data)
        for path, text in more.items():
            new.writestr(f"resources/{path}.py", text)
    return file
