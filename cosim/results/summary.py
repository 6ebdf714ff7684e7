"""summary.json: what ran, how it ended, what it cost and what came out."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from cosim.engine.master import Outcome
from cosim.model.assembly import Node
from cosim.model.clock import SECOND, to_seconds

SUMMARY = "summary.json"


def summarise(
    scenario: str,
    seed: int,
    outcome: Outcome,
    nodes: Mapping[str, Node],
    metrics: Mapping[str, float],
    record_every: int = 0,
    unrecorded: Sequence[str] = (),
) -> dict[str, Any]:
    """The summary as data; `stop_time` is the simulated time reached, times in seconds; `record_every` [ns].

    `unrecorded` are the patterns of signals that were left out of the results.
    """
    wall = outcome.wall / SECOND
    return {
        "scenario": scenario,
        "status": outcome.status,
        "reason": outcome.reason,
        "stop_time": to_seconds(outcome.time),
        "wall_time": wall,
        "real_time_factor": to_seconds(outcome.time) / wall if wall else 0.0,
        "record_every": to_seconds(record_every),
        "unrecorded": list(unrecorded),
        "seed": seed,
        "git": code_version(),
        "instances": {name: _instance(name, node, outcome) for name, node in nodes.items()},
        "metrics": {name: _finite(value) for name, value in metrics.items()},
    }


def write_summary(summary: Mapping[str, Any], folder: Path) -> None:
    """Write `folder`/summary.json, which then is whole: on OSError no file is left."""
    partial = folder / f"{SUMMARY}.partial"
    try:
        partial.write_text(to_json(summary) + "\n", "utf-8")
        partial.replace(folder / SUMMARY)
    except OSError:
        with suppress(OSError):
            partial.unlink()
        raise


def to_json(summary: Mapping[str, Any]) -> str:
    """The summary as indented JSON text without NaN."""
    return json.dumps(summary, indent=2, allow_nan=False)


def code_version() -> str:
    """The git commit of this code with "-dirty" if it was changed, or the version of the installed package."""
    root = Path(__file__).resolve().parents[2]
    if (root / ".git").exists():
        command = ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=12"]
        try:
            return subprocess.run(command, capture_output=True, text=True, check=True, timeout=5).stdout.strip()
        except (OSError, subprocess.SubprocessError):
            return "unknown"
    from importlib import metadata  # noqa: PLC0415  (only for installed copies)

    try:
        return metadata.version("vehicle-formation-fmus")
    except metadata.PackageNotFoundError:
        return "unknown"


def _instance(name: str, node: Node, outcome: Outcome) -> dict[str, Any]:
    return {
        "model": node.face.model,
        "period": to_seconds(node.period),
        "calls": outcome.calls.get(name, 0),
        "time": outcome.times.get(name, 0) / SECOND,
    }


def _finite(value: float) -> float | None:
    """JSON has no NaN: a metric that cannot be computed is null."""
    return float(value) if math.isfinite(value) else None
