"""documentation/index.html of an FMU: one page without scripts or links to elsewhere, readable from an unpacked FMU."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from types import MappingProxyType

from markdown_it import MarkdownIt

from fmukit.interface import Interface, Variable
from fmukit.reference_run import ReferenceRun

NONE: Mapping[str, str] = MappingProxyType({})
_INDEX = re.compile(r"\[\d+]")
_STYLE = """
body { font: 15px/1.5 sans-serif; max-width: 62em; margin: 2em auto; padding: 0 1em; color: #222; }
h1, h2 { color: #1f3a5f; } h2 { border-bottom: 1px solid #ccd; margin-top: 2em; }
table { border-collapse: collapse; font-size: 13px; margin: 1em 0; }
th, td { border: 1px solid #ccd; padding: 0.2em 0.6em; text-align: left; vertical-align: top; }
th { background: #eef3f8; } pre { background: #f6f8fa; padding: 0.8em; overflow-x: auto; line-height: 1.35; }
code { font-size: 13px; } img { max-width: 100%; }
"""
_PAGE = """<!DOCTYPE html>
<html lang="en">
<head><meta charset="utf-8"><title>{name}</title><style>{style}</style></head>
<body>
{body}
</body>
</html>
"""


def page(
    interface: Interface, readme: str, run: ReferenceRun | None, version: str, packages: Mapping[str, str] = NONE
) -> str:
    """What the FMU is, its reference run, its README and its variables. Pictures are files of the FMU."""
    parts = [_head(interface, version, needs(packages)), _run(run), _readme(readme), *_tables(interface)]
    return _PAGE.format(name=escape(interface.name), style=_STYLE, body="\n".join(part for part in parts if part))


def needs(packages: Mapping[str, str]) -> str:
    """What the host needs, as the end of a sentence."""
    if not packages:
        return "a Python 3 interpreter and no Python packages"
    listed = " and ".join(f"{name} {least} or newer" for name, least in packages.items())
    return f"a Python 3 interpreter with {listed}"


def _head(interface: Interface, version: str, needed: str) -> str:
    substep = f", in substeps of at most {interface.max_substep:g} s" if interface.kind == "continuous" else ""
    kinds = {
        "continuous": "Continuous: it integrates over the step it is given",
        "sampled": "Sampled: it computes on a grid of its own from the inputs it holds, and keeps its outputs between",
    }
    return f"""<h1>{escape(interface.name)}</h1>
<p>{escape(interface.description)}.</p>
<p>{kinds[interface.kind]}{substep}. Default step {interface.step:g} s.
FMI 2.0 co-simulation, version {escape(version)}. The host needs {needed}.
A refused or failed step sets the output <code>fault</code>, keeps all other outputs and is discarded; the reason is in
the log. Licences: <a href="licenses/">licenses/</a>.</p>
<p><img src="../model.png" alt="Block with the ports of {escape(interface.name)}"></p>"""


def _run(run: ReferenceRun | None) -> str:
    if run is None:
        return ""
    return f"""<h2>Reference run</h2>
<p>{escape(run.text)} All parameters have their start values; communication step {run.step:g} s.</p>
<p><img src="reference_run.png" alt="Plot of the reference run"></p>"""


def _readme(text: str) -> str:
    """The README, its headings one level down; HTML in it is shown as text."""
    if not text:
        return ""
    title, _, rest = text.partition("\n")
    rest = rest if title.startswith("# ") else text
    html: str = MarkdownIt("commonmark", {"html": False}).enable("table").render(rest)
    levels = re.sub(r"<(/?)h([1-5])>", lambda found: f"<{found[1]}h{int(found[2]) + 1}>", html)
    return f"<h2>What it computes</h2>\n{levels}"


def _tables(interface: Interface) -> Iterable[str]:
    for causality, title in (("input", "Inputs"), ("output", "Outputs"), ("parameter", "Parameters")):
        variables = interface.select(causality)  # type: ignore[arg-type]
        if variables:
            yield f"<h2>{title}</h2>\n{_table(variables)}"


def _table(variables: Sequence[Variable]) -> str:
    """Rows of variables with only the columns that say something; members of an array share a row."""
    columns = {
        "name": [_name(family) for family in _arrays(variables)],
        "unit": [family[0].unit for family in _arrays(variables)],
        "start": [_start(family[0]) for family in _arrays(variables)],
        "range": [_range(family[0]) for family in _arrays(variables)],
        "what it is": [_text(family) for family in _arrays(variables)],
        "source": [family[0].source for family in _arrays(variables)],
    }
    kept = {heading: cells for heading, cells in columns.items() if any(cells)}
    head = "".join(f"<th>{heading}</th>" for heading in kept)
    rows = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in zip(*kept.values(), strict=True)]
    return "\n".join(["<table>", f"<tr>{head}</tr>", *(f"<tr>{row}</tr>" for row in rows), "</table>"])


def _arrays(variables: Sequence[Variable]) -> list[list[Variable]]:
    families: dict[str, list[Variable]] = {}
    for variable in variables:
        families.setdefault(_INDEX.sub("[]", variable.name), []).append(variable)
    return list(families.values())


def _name(family: list[Variable]) -> str:
    first, last = (_INDEX.findall(variable.name) for variable in (family[0], family[-1]))
    return _INDEX.sub(f"[{first[0][1:-1]}..{last[0][1:-1]}]", family[0].name) if len(family) > 1 else family[0].name


def _text(family: list[Variable]) -> str:
    return family[0].description + (" (the first of them)" if len(family) > 1 else "")


def _start(variable: Variable) -> str:
    if variable.causality == "output":
        return ""
    if isinstance(variable.start, bool | str):
        return str(variable.start).lower() if isinstance(variable.start, bool) else variable.start or "(empty)"
    return f"{variable.start:.10g}"


def _range(variable: Variable) -> str:
    low, high = variable.minimum, variable.maximum
    if low is None and high is None:
        return variable.type if variable.type in ("Boolean", "String") else ""
    return f"{'' if low is None else f'{low:g}'} … {'' if high is None else f'{high:g}'}"
