"""Pictures of signals over time, one axis per unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import CosimError
from cosim.results.reading import Results
from fmukit.errors import because


def plotted(runs: Mapping[str, Results], names: Sequence[str]) -> Any:
    """A matplotlib figure of the signals of one or more runs; of several, each line says of which it is."""
    import matplotlib as mpl  # noqa: PLC0415 - takes a quarter of a second, which only a picture is worth
    from matplotlib import pyplot as plt  # noqa: PLC0415

    first = next(iter(runs.values()))
    units = list(dict.fromkeys(first.unit(name) for name in names))
    figure, axes = plt.subplots(len(units), 1, sharex=True, squeeze=False, figsize=(9, 1 + 2.6 * len(units)))
    styles = ("-", "--", ":", "-.")
    colours = mpl.rcParams["axes.prop_cycle"].by_key()["color"]
    for axis, unit in zip(axes[:, 0], units, strict=True):
        own = [name for name in names if first.unit(name) == unit]
        for k, name in enumerate(own):
            for style, (run, results) in zip(styles, runs.items(), strict=False):
                values = np.asarray(results[name], float)
                label = name if len(runs) == 1 else f"{name}, {run}"
                axis.plot(results.time, values, style, color=colours[k % len(colours)], label=label, linewidth=1.2)
        axis.set_ylabel(f"[{unit}]" if unit else "")
        axis.legend(fontsize="small")
        axis.grid(alpha=0.3)
    axes[-1, 0].set_xlabel("time [s]")
    figure.tight_layout()
    return figure


def save(figure: Any, file: Path) -> None:
    """Write the figure; the suffix decides on the format. Raises CosimError."""
    try:
        figure.savefig(file, dpi=150)
    except OSError as error:
        raise CosimError(f"{file} cannot be written: {because(error)}") from None
    except ValueError:
        raise CosimError(f"{file} has no suffix of a picture; write .png, .svg or .pdf") from None
