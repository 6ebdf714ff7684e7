"""Files of SSP as text, and small FMUs to go with them."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path

from small_c import foreign, variable

from cosim.command.opening import opened
from cosim.run.request import Request
from cosim.run.running import Finished, run
from cosim.ssp.namespaces import PREFIXES

SPACES = " ".join(f'xmlns:{prefix}="{namespace}"' for prefix, namespace in PREFIXES.items())
HEAD = '<?xml version="1.0" encoding="UTF-8"?>\n'
UNITS = {
    "m": 'm="1"',
    "mm": 'm="1" factor="0.001"',
    "K": 'K="1"',
    "degC": 'K="1" offset="273.15"',
    "rad": 'rad="1"',
    "deg": 'rad="1" factor="0.017453292519943295"',
}


def units(prefix: str) -> str:
    """The element Units of a file."""
    inner = "".join(f'<ssc:Unit name="{name}"><ssc:BaseUnit {base}/></ssc:Unit>' for name, base in UNITS.items())
    return f"<{prefix}:Units>{inner}</{prefix}:Units>"


def ssd(system: str, *, end: str = '<ssd:DefaultExperiment stopTime="0.3"/>', version: str = "1.0") -> str:
    """A description whose root system contains `system`."""
    return (
        f'{HEAD}<ssd:SystemStructureDescription version="{version}" name="test" {SPACES}>\n'
        f'<ssd:System name="root">{system}</ssd:System>{units("ssd")}{end}</ssd:SystemStructureDescription>'
    )


def elements(*inner: str) -> str:
    return f"<ssd:Elements>\n{chr(10).join(inner)}\n</ssd:Elements>"


def component(name: str, source: str, connectors: str = "", bindings: str = "", **attributes: str) -> str:
    """`connectors` such as "u=input y=output:m", the unit or else the type after a colon."""
    extra = "".join(f' {key}="{value}"' for key, value in attributes.items())
    inner = connected(connectors) + bound(bindings)
    return f'<ssd:Component name="{name}" source="{source}"{extra}>{inner}</ssd:Component>'


def connected(connectors: str) -> str:
    """The element Connectors."""
    made = ""
    for each in connectors.split():
        name, _, kind = each.partition("=")
        kind, _, unit = kind.partition(":")
        type_ = f'<ssc:Real unit="{unit}"/>' if unit in UNITS else f"<ssc:{unit or 'Real'}/>"
        if unit.startswith("Enumeration"):
            type_ = f'<ssc:Enumeration name="{unit.partition("-")[2]}"/>'
        made += f'<ssd:Connector name="{name}" kind="{kind}">{type_}</ssd:Connector>'
    return f"<ssd:Connectors>{made}</ssd:Connectors>" if made else ""


def bound(bindings: str) -> str:
    return f"<ssd:ParameterBindings>{bindings}</ssd:ParameterBindings>" if bindings else ""


def parameters(values: Mapping[str, str | float]) -> str:
    """A parameter set of Real values, or of what stands as an element."""
    inner = "".join(
        f'<ssv:Parameter name="{name}">{value if isinstance(value, str) else _real(value)}</ssv:Parameter>'
        for name, value in values.items()
    )
    return (
        f'<ssv:ParameterSet version="1.0" name="values" {SPACES}><ssv:Parameters>{inner}</ssv:Parameters>'
        f"{units('ssv')}</ssv:ParameterSet>"
    )


def _real(value: float) -> str:
    return f'<ssv:Real value="{value!r}"/>'


def binding(values: Mapping[str, str | float], mapping: str = "", prefix: str = "") -> str:
    """An inline binding; `mapping` are the entries of one."""
    entries = f'<ssm:ParameterMapping version="1.0">{mapping}</ssm:ParameterMapping>'
    mapped = f"<ssd:ParameterMapping>{entries}</ssd:ParameterMapping>" if mapping else ""
    inner = f"<ssd:ParameterValues>{parameters(values)}</ssd:ParameterValues>{mapped}"
    return f'<ssd:ParameterBinding prefix="{prefix}">{inner}</ssd:ParameterBinding>'


def connections(*pairs: str) -> str:
    """Such as "a.y b.u", "x a.u" for a connector of the system itself, and a transformation behind."""
    made = ""
    for pair in pairs:
        start, end, *more = pair.split(" ", 2)
        suppress, inner = "", "".join(more)
        if inner.startswith("suppress"):
            suppress, inner = ' suppressUnitConversion="true"', inner.removeprefix("suppress")
        made += f"<ssd:Connection {_end('start', start)} {_end('end', end)}{suppress}>{inner}</ssd:Connection>\n"
    return f"<ssd:Connections>\n{made}</ssd:Connections>"


def _end(side: str, text: str) -> str:
    element, _, connector = text.rpartition(".")
    return (f'{side}Element="{element}" ' if element else "") + f'{side}Connector="{connector}"'


def packed(file: Path, members: Mapping[str, str | bytes | Path]) -> Path:
    """An archive with texts, bytes and files."""
    with zipfile.ZipFile(file, "w") as archive:
        for name, content in members.items():
            archive.writestr(name, content.read_bytes() if isinstance(content, Path) else content)
    return file


def gain(file: Path, *, input_unit: str = "", output_unit: str = "", **options: str) -> Path:
    """y = k u; both k and u start with 1."""
    real = {"unit": input_unit} if input_unit else {}
    ports = [
        variable("u", 0, "input", start="1", **real),
        variable("k", 1, "parameter", start="1", variability="fixed", initial="exact"),
        variable("y", 2, "output", **({"unit": output_unit} if output_unit else {})),
    ]
    computed = "m->r[2] = (m->i[1] ? m->r[1] : 1.0) * (m->i[0] ? m->r[0] : 1.0);"
    step = {
        "fmi2SetReal": "for (size_t i = 0; i < n; ++i) { m->r[vr[i]] = v[i]; m->i[vr[i]] = 1; }",
        "fmi2DoStep": computed,
        "fmi2ExitInitializationMode": computed,
    }
    known = "".join(f'<Unit name="{name}"><BaseUnit {base}/></Unit>' for name, base in UNITS.items())
    return foreign(file, ports, step, units=known, **options)


def ran(path: Path | str, folder: Path, **options: object) -> Finished:
    """The run of a file."""
    with opened(str(path)) as scenario:
        return run(Request(scenario, folder, **options))


def last(path: Path | str, folder: Path, signal: str, **options: object) -> float:
    """The last value of a signal in the run of a file."""
    return float(ran(path, folder, **options).results[signal][-1])
