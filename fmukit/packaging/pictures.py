"""Pictures of an FMU as PNG files: its block with grouped ports, and the plot of its reference run.

The same data and matplotlib give the same bytes, whatever the user's matplotlib settings: default style, no metadata.
"""

from __future__ import annotations

import io
import re
import textwrap
from collections.abc import Sequence

from matplotlib import style
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from fmukit.interface import Interface
from fmukit.packaging.recording import Recording

_DPI = 100
_LINE, _LEFT, _RIGHT, _ARROW = 0.2, 3.3, 5.7, 0.3
_EDGE = "#1f3a5f"
_INDEX = re.compile(r"\[\d+]")
_LONGEST = 40


def families(names: Sequence[str]) -> list[str]:
    """Names in one line per family: ["a.x", "a.y", "b[1].c", "b[2].c"] -> ["a.{x, y}", "b[1..2].c"]."""
    members: dict[str, dict[str, None]] = {}
    indices: dict[str, list[int]] = {}
    for name in names:
        parent, _, member = _INDEX.sub("[]", name).rpartition(".")
        members.setdefault(parent, {})[member] = None
        indices.setdefault(parent, []).extend(int(found[1:-1]) for found in _INDEX.findall(name))
    return [line for parent, inner in members.items() for line in _lines(parent, list(inner), indices[parent])]


def _lines(parent: str, members: list[str], indices: list[int]) -> list[str]:
    if not parent:
        return members
    shown = parent.replace("[]", f"[{min(indices)}..{max(indices)}]") if indices else parent
    if len(members) == 1:
        return [f"{shown}.{members[0]}"]
    line = f"{shown}.{{{', '.join(members)}}}"
    return [line if len(line) <= _LONGEST else f"{shown}.* ({len(members)})"]


def block(interface: Interface) -> bytes:
    """The block: inputs left, outputs right, name and purpose inside."""
    inputs = families(interface.names("input"))
    outputs = [*families(interface.names("output")), "fault"]
    height = _LINE * (max(len(inputs), len(outputs), 8) + 2)
    with style.context("default"):
        figure = Figure(figsize=(9.0, height), dpi=_DPI)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, 9.0), ylim=(0.0, height))
        axes.axis("off")
        box = Rectangle((_LEFT, _LINE / 2), _RIGHT - _LEFT, height - _LINE, fc="#eef3f8", ec=_EDGE, lw=1.5)
        axes.add_patch(box)
        axes.text(4.5, height / 2 + 0.2, interface.name, ha="center", va="center", fontsize=12, weight="bold")
        about = textwrap.fill(f"{interface.description}. {interface.kind.capitalize()}, {interface.step:g} s.", 36)
        axes.text(4.5, height / 2, about, ha="center", va="top", fontsize=7.5, color="#333333")
        _ports(axes, inputs, height / 2, _LEFT - _ARROW, "left")
        _ports(axes, outputs, height / 2, _RIGHT, "right")
        return _png(figure)


def _ports(axes: Axes, lines: list[str], middle: float, tail: float, side: str) -> None:
    """One arrow per line from `tail` on, spread around `middle`; the text stands on the outer side of the block."""
    x = tail - 0.08 if side == "left" else tail + _ARROW + 0.08
    for i, line in enumerate(lines):
        y = middle + _LINE * ((len(lines) - 1) / 2 - i)
        arrow = {"arrowstyle": "-|>", "color": _EDGE, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (tail + _ARROW, y), (tail, y), arrowprops=arrow)
        outer = "right" if side == "left" else "left"
        axes.text(x, y, line, ha=outer, va="center", fontsize=7.5, family="monospace")


def plot(interface: Interface, recording: Recording) -> bytes:
    """The reference run: one panel per entry of its `plots` over time."""
    units = {variable.name: variable.unit for variable in interface.select("output")}
    panels = recording.run.plots
    with style.context("default"):
        figure = Figure(figsize=(8.0, 2.0 * len(panels) + 0.4), dpi=_DPI, layout="constrained")
        for axes, (title, names) in zip(figure.subplots(len(panels), squeeze=False)[:, 0], panels.items(), strict=True):
            for name in names:
                axes.plot(recording.times, recording.outputs[name], label=name, linewidth=1.2)
            axes.set_title(title, fontsize=9, loc="left")
            axes.set_ylabel(f"[{units[names[0]]}]", fontsize=8)
            axes.tick_params(labelsize=8)
            axes.grid(alpha=0.3)
            axes.legend(fontsize=7, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
        axes.set_xlabel("time [s]", fontsize=8)
        return _png(figure)


def _png(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    FigureCanvasAgg(figure)
    figure.savefig(buffer, format="png", dpi=_DPI, metadata={"Software": None})
    return buffer.getvalue()
