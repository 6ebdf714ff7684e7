"""The process the rules of a running FMU are applied in: it answers questions, see `fmukit.conformance.answers`.

It is asked on its standard input and answers on its standard output, which the FMU does not find where they were.
Arguments: the FMU file, the folder it is unpacked in, then pairs of other FMUs. Whatever the FMU does to this process,
the one who asks is told by `attendant`.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from fmukit.conformance.answers import answer
from fmukit.conformance.bare import host, pulse
from fmukit.conformance.bench import Bench
from fmukit.conformance.package import Package
from fmukit.conformance.rule import look
from fmukit.conformance.rulebook import RUNNING

_BY_ID = {rule.id: rule for rule in RUNNING}
_FAILED = 70


def _work(bench: Bench, questions: int, answers: int) -> None:
    """Answer one question after the other; the key of a question is not read before the one before is answered."""
    with os.fdopen(questions, "rb", buffering=0) as stream:
        while line := stream.readline():
            question = json.loads(line)
            finding = look(_BY_ID[question["rule"]], bench)
            seen = [sentence.removeprefix("CallFailed: ") for sentence in finding.seen]
            answer(answers, question["key"], finding.status, seen)


def _main(arguments: list[str]) -> None:
    """The process ends without asking the FMU's libraries."""
    questions, answers = os.dup(0), os.dup(1)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)
    file, folder, *others = arguments
    beat = pulse.own()
    if beat is not None:
        host.ears.append(beat.beat)
    beside = tuple(_bench(*pair) for pair in zip(others[::2], others[1::2], strict=True))
    try:
        _work(_bench(file, folder, beside), questions, answers)
    except OSError as error:
        os.write(2, f"the checker cannot answer any more: {error}\n".encode())
        os._exit(_FAILED)
    os._exit(0)


def _bench(file: str, folder: str, others: tuple[Bench, ...] = ()) -> Bench:
    return Bench(Package.read(file), Path(folder), others)


if __name__ == "__main__":
    _main(sys.argv[1:])
