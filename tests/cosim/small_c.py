"""FMUs as other tools write them: one C file each, its attributes and the body of every call chosen by the test."""

from __future__ import annotations

import subprocess
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

from fmpy import platform, sharedLibraryExtension

_CALLS = {
    "fmi2SetDebugLogging": "int on, size_t n, const char *const *names",
    "fmi2SetupExperiment": "int defined, double tolerance, double start, int stops, double stop",
    "fmi2EnterInitializationMode": "",
    "fmi2ExitInitializationMode": "",
    "fmi2Terminate": "",
    "fmi2Reset": "",
    "fmi2SetReal": "const unsigned *vr, size_t n, const double *v",
    "fmi2GetReal": "const unsigned *vr, size_t n, double *v",
    "fmi2SetInteger": "const unsigned *vr, size_t n, const int *v",
    "fmi2GetInteger": "const unsigned *vr, size_t n, int *v",
    "fmi2SetBoolean": "const unsigned *vr, size_t n, const int *v",
    "fmi2GetBoolean": "const unsigned *vr, size_t n, int *v",
    "fmi2SetString": "const unsigned *vr, size_t n, const char *const *v",
    "fmi2GetString": "const unsigned *vr, size_t n, const char **v",
    "fmi2DoStep": "double t, double h, int no_set",
    "fmi2GetBooleanStatus": "int k, int *v",
}
"""The calls with an instance, and their arguments after it."""
_REFUSED = [
    *(f"fmi2Get{kind}Status" for kind in ("", "Real", "Integer", "String")),
    *(f"fmi2{what}FMUstate" for what in ("Get", "Set", "Free", "Serialize", "DeSerialize")),
    *("fmi2SerializedFMUstateSize", "fmi2CancelStep", "fmi2GetDirectionalDerivative"),
    *("fmi2SetRealInputDerivatives", "fmi2GetRealOutputDerivatives"),
]
_BODIES = {
    "fmi2GetBooleanStatus": "return 2;",
    "fmi2SetReal": "for (size_t i = 0; i < n; ++i) m->r[vr[i]] = v[i];",
    "fmi2GetReal": "for (size_t i = 0; i < n; ++i) v[i] = m->r[vr[i]];",
    "fmi2SetInteger": "for (size_t i = 0; i < n; ++i) m->i[vr[i]] = v[i];",
    "fmi2GetInteger": "for (size_t i = 0; i < n; ++i) v[i] = m->i[vr[i]];",
    "fmi2SetBoolean": "for (size_t i = 0; i < n; ++i) m->i[vr[i]] = v[i];",
    "fmi2GetBoolean": "for (size_t i = 0; i < n; ++i) v[i] = m->i[vr[i]];",
}
_HEAD = """#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define API __attribute__((visibility("default")))
typedef struct { double r[16]; int i[16], steps; char name[64], where[1024]; } Instance;
static double shared;
API const char *fmi2GetTypesPlatform(void) { return "default"; }
API const char *fmi2GetVersion(void) { return "2.0"; }
API void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *where, void *host, int v, int l) {
  Instance *m = calloc(1, sizeof *m);
  snprintf(m->name, sizeof m->name, "%s", name);
  snprintf(m->where, sizeof m->where, "%s", strncmp(where, "file://", 7) ? where : where + 7);
  return m;
}
"""
_DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Foreign" guid="{{foreign}}" generationTool="another tool">
<CoSimulation modelIdentifier="foreign" {flags}/>
{units}{types}
{experiment}
<ModelVariables>
{variables}
</ModelVariables>
<ModelStructure><Outputs>{outputs}</Outputs></ModelStructure>
</fmiModelDescription>"""
EXPERIMENT = '<DefaultExperiment startTime="0" stopTime="1" stepSize="0.1"/>'


def variable(name: str, reference: int, causality: str, kind: str = "Real", **attributes: str) -> str:
    """A ScalarVariable; `variability` and `initial` belong to it, all other attributes to its type."""
    of_variable = {key: attributes.pop(key) for key in ("variability", "initial") if key in attributes}
    head = _attributes({"name": name, "valueReference": str(reference), "causality": causality, **of_variable})
    return f"<ScalarVariable{head}><{kind}{_attributes(attributes)}/></ScalarVariable>"


def foreign(
    file: Path,
    variables: Sequence[str],
    calls: Mapping[str, str] | None = None,
    *,
    flags: str = 'canHandleVariableCommunicationStepSize="true"',
    units: str = "",
    types: str = "",
    experiment: str = EXPERIMENT,
    resources: Mapping[str, bytes] | None = None,
) -> Path:
    """The FMU `file`; `calls` gives C statements for calls that do more than keep values (`m` is the instance)."""
    source, library = file.with_suffix(".c"), file.with_suffix(".so")
    source.write_text(_source(dict(calls or {})))
    options = ["-std=gnu11", "-O1", "-ffp-contract=off", "-w", "-shared", "-fPIC", "-fvisibility=hidden"]
    subprocess.run(["cc", *options, "-o", str(library), str(source), "-lm"], check=True)
    outputs = [index for index, text in enumerate(variables, start=1) if 'causality="output"' in text]
    description = _DESCRIPTION.format(
        flags=flags,
        units=units and f"<UnitDefinitions>{units}</UnitDefinitions>",
        types=types and f"<TypeDefinitions>{types}</TypeDefinitions>",
        experiment=experiment,
        variables="\n".join(variables),
        outputs="".join(f'<Unknown index="{index}"/>' for index in outputs),
    )
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.write(library, f"binaries/{platform}/foreign{sharedLibraryExtension}")
        for name, data in (resources or {}).items():
            archive.writestr(f"resources/{name}", data)
    return file


def _source(bodies: dict[str, str]) -> str:
    bodies = _BODIES | bodies
    free = bodies.pop("fmi2FreeInstance", "")
    functions = [
        f"API int {name}(Instance *m{', ' * bool(arguments)}{arguments}) {{ {bodies.get(name, '')} return 0; }}"
        for name, arguments in _CALLS.items()
    ]
    functions += [f"API int {name}() {{ return 3; }}" for name in _REFUSED]
    return "\n".join([_HEAD, *functions, f"API void fmi2FreeInstance(Instance *m) {{ {free} free(m); }}", ""])


def _attributes(values: Mapping[str, str]) -> str:
    return "".join(f" {name}={quoteattr(value)}" for name, value in values.items())
