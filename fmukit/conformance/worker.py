"""The process the rules of a running FMU are applied in: one line of JSON per event on the standard output.

Arguments: the FMU file, the folder it is unpacked in, the number of the first rule, then pairs of other FMUs. Before a
rule it says {"begin": number}, after it {"number": ..., "status": ..., "seen": [...]}.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import IO

from fmukit.conformance.bench import Bench
from fmukit.conformance.groups import RULES
from fmukit.conformance.package import Package
from fmukit.conformance.rule import look


def work(bench: Bench, begin: str, answer_to: IO[str]) -> None:
    """Apply all rules from `begin` on."""
    numbers = [rule.number for rule in RULES]
    for rule in RULES[numbers.index(begin) :]:
        _say(answer_to, {"begin": rule.number})
        finding = look(rule, bench)
        seen = [sentence.removeprefix("CallFailed: ") for sentence in finding.seen]
        _say(answer_to, {"number": rule.number, "status": finding.status, "seen": seen})


def _say(answer_to: IO[str], event: dict[str, object]) -> None:
    answer_to.write(json.dumps(event) + "\n")
    answer_to.flush()


def _main(arguments: list[str]) -> None:
    """Nothing the FMU prints may go where the answers go; the process ends without asking the FMU's libraries."""
    answer_to = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    file, folder, begin, *others = arguments
    beside = tuple(_bench(*pair) for pair in zip(others[::2], others[1::2], strict=True))
    work(_bench(file, folder, beside), begin, answer_to)
    os._exit(0)


def _bench(file: str, folder: str, others: tuple[Bench, ...] = ()) -> Bench:
    return Bench(Package.read(file), Path(folder), others)


if __name__ == "__main__":
    _main(sys.argv[1:])
