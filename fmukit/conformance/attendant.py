"""One worker under guard: put it a question for each rule, and know what to say when no answer comes."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from time import monotonic
from types import TracebackType
from typing import Any, Self

import fmukit
from fmukit.conformance.answers import Listener
from fmukit.conformance.bare import pulse
from fmukit.conformance.deadline import Deadline
from fmukit.conformance.printed import Printed
from fmukit.conformance.rule import Finding, Rule
from fmukit.guard.ending import Ending
from fmukit.guard.guarded import Guarded
from fmukit.guard.keeper.limits import MIB, Limits
from fmukit.guard.stopwatch import Stopwatch

_BLINK, _LAST = 0.1, 1.0
_MOST_MEMORY = 4096 * MIB


def limits() -> Limits:
    """What an FMU may use while it is checked: 4 GiB of memory, or half of what the machine has, and 64 processes."""
    try:
        machine = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    except (ValueError, AttributeError, OSError):
        return Limits()
    return Limits(memory=min(_MOST_MEMORY, machine // 2))


class Attendant:
    """A worker that runs the FMU of `arguments` in the folder `scratch`. Use it in a `with`, which ends it."""

    def __init__(self, arguments: Sequence[str], scratch: Path, deadline: Deadline, until: float) -> None:
        self._deadline, self._until = deadline, until
        self._pulse = scratch / "pulse"
        pulse.prepare(self._pulse)
        self._guarded = Guarded(
            [sys.executable, "-m", "fmukit.conformance.worker", *arguments],
            limits=limits(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            cwd=_folder(scratch, "work"),
            env=_environment(scratch, self._pulse),
            writable=[scratch],
        )
        questions, answers, printed = self._guarded.stdin, self._guarded.stdout, self._guarded.stderr
        assert questions is not None and answers is not None and printed is not None
        self._printed = Printed(printed)
        self._listener = Listener(questions, answers)
        self._watch = Stopwatch(self._guarded)
        self.alive = True

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()
        self._printed.last()
        self._guarded.__exit__(kind, error, trace)

    @property
    def strays(self) -> list[str]:
        """Lines in the channel of answers that answered nothing."""
        return self._listener.strays

    def ask(self, rule: Rule[Any]) -> Finding:
        """The finding of a rule; afterwards the worker may not be `alive` any more."""
        began = beaten = self._watch.look()
        count = -1
        self._listener.ask(rule.id)
        while True:
            ending = self._guarded.poll()
            self._hear(0.0 if ending else _BLINK)
            answer = self._listener.answer()
            if answer is not None:
                return Finding(rule, answer[0], answer[1])  # type: ignore[arg-type]
            if ending is not None:
                return self._died(rule, ending)
            now = self._watch.look()
            beats, call = pulse.read(self._pulse)
            if beats != count:
                count, beaten = beats, now
            over = self._deadline.over(call, now - beaten, now - began) or self._all_over()
            if over is not None:
                self._end()
                return Finding(rule, over[0], (over[1],))  # type: ignore[arg-type]

    def _all_over(self) -> tuple[str, str] | None:
        if monotonic() < self._until:
            return None
        return "undecided", f"the whole check was given {self._deadline.check:g} s, which are over"

    def _hear(self, seconds: float) -> None:
        """What it answers within that time; all there is left when there is no time to wait."""
        if seconds and self._listener.open:
            self._listener.listen(seconds)
        elif seconds:
            self._guarded.wait(seconds)  # it has closed the channel and must end, or its time must
        else:
            while self._listener.listen(_LAST):
                pass

    def _died(self, rule: Rule[Any], ending: Ending) -> Finding:
        self._end()
        _, call = pulse.read(self._pulse)
        last = self._printed.last()
        where = f" in {call}" if call else ""
        said = f", after printing {last!r}" if last else ""
        return Finding(rule, "fail", (f"the process {ending.words(self._guarded.limits)}{where}{said}",))

    def _end(self) -> None:
        self._guarded.end()
        self._hear(0.0)
        self.alive = False


def _folder(scratch: Path, name: str) -> Path:
    folder = scratch / name
    folder.mkdir(exist_ok=True)
    return folder


def _environment(scratch: Path, place: Path) -> dict[str, str]:
    """With a folder of its own for temporary files, and this very package."""
    temporary = str(_folder(scratch, "temporary"))
    root = str(Path(fmukit.__file__).resolve().parents[1])
    path = os.pathsep.join([root, *filter(None, [os.environ.get("PYTHONPATH")])])
    own = dict.fromkeys(("TMPDIR", "TEMP", "TMP"), temporary) | {"PYTHONPATH": path, pulse.PLACE: str(place)}
    return dict(os.environ) | own
