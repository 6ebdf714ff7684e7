"""The process the rules of a running FMU are applied in: one line of JSON per event on the standard output.

Arguments: the FMU file, the folder it is unpacked in, the ids of the rules, then pairs of other FMUs. Before a rule
it says {"begin": id}, after it {"rule": id, "status": ..., "seen": [...]}.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import IO

from fmukit.conformance.bench import Bench
from fmukit.conformance.package import Package
from fmukit.conformance.rule import look
from fmukit.conformance.rulebook import RUNNING


def work(bench: Bench, ids: Sequence[str], answer_to: IO[str]) -> None:
    """Apply the rules of those ids."""
    for rule in (rule for rule in RUNNING if rule.id in ids):
        _say(answer_to, {"begin": rule.id})
        finding = look(rule, bench)
        seen = [sentence.removeprefix("CallFailed: ") for sentence in finding.seen]
        _say(answer_to, {"rule": rule.id, "status": finding.status, "seen": seen})


def _say(answer_to: IO[str], event: dict[str, object]) -> None:
    answer_to.write(json.dumps(event) + "\n")
    answer_to.flush()


def _main(arguments: list[str]) -> None:
    """Nothing the FMU prints may go where the answers go; the process ends without asking the FMU's libraries."""
    answer_to = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    file, folder, ids, *others = arguments
    beside = tuple(_bench(*pair) for pair in zip(others[::2], others[1::2], strict=True))
    work(_bench(file, folder, beside), ids.split(","), answer_to)
    os._exit(0)


def _bench(file: str, folder: str, others: tuple[Bench, ...] = ()) -> Bench:
    return Bench(Package.read(file), Path(folder), others)


if __name__ == "__main__":
    _main(sys.argv[1:])
