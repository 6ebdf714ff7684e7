"""`Guarded`: a foreign command with its keeper, from the side of the one who started it."""

from __future__ import annotations

import json
import os
import secrets
import select
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from time import monotonic
from types import TracebackType
from typing import IO, Any, Self

from fmukit.guard.ending import Ending
from fmukit.guard.keeper import processes
from fmukit.guard.keeper.limits import Limits

_KEEPER = Path(processes.__file__).parent
MARK = "FMUKIT_GUARDED"
"""The environment variable that all processes under one guard share."""
_PATIENCE, _TRIES = 0.5, 20


class Guarded:
    """A command under guard, started at once. Use it in a `with`, whose end is the end of all it started.

    `stdin`, `stdout`, `stderr` are as for subprocess.Popen (default: nothing), and so are `cwd`, `env` (default: that
    of this process) and `pass_fds`. `writable` puts it behind a fence (see `keeper.fence`): it can change nothing but
    those folders, and send signals to none but its own processes. Raises OSError if no process can be started.

    On Windows there is no keeper: no limits hold, and the processes it started are ended by taskkill.
    """

    def __init__(
        self,
        command: Sequence[str],
        *,
        limits: Limits | None = None,
        stdin: Any = subprocess.DEVNULL,
        stdout: Any = subprocess.DEVNULL,
        stderr: Any = subprocess.DEVNULL,
        cwd: Path | str | None = None,
        env: Mapping[str, str] | None = None,
        pass_fds: Sequence[int] = (),
        writable: Sequence[Path] | None = None,
    ) -> None:
        self.limits = Limits() if limits is None else limits
        self._mark = f"{MARK}={secrets.token_hex(16)}"
        self._ending: Ending | None = None
        self._pid: int | None = None
        self._text = b""
        environment = {**(os.environ if env is None else env), MARK: self._mark.partition("=")[2]}
        settings: dict[str, Any] = {
            "stdin": stdin, "stdout": stdout, "stderr": stderr, "cwd": cwd, "env": environment
        }  # fmt: skip
        if sys.platform == "win32":
            flags = subprocess.CREATE_NEW_PROCESS_GROUP
            self._process = subprocess.Popen(command, creationflags=flags, **settings)
        else:
            self._start(command, tuple(pass_fds), None if writable is None else list(map(str, writable)), settings)
        self.stdin: IO[bytes] | None = self._process.stdin
        self.stdout: IO[bytes] | None = self._process.stdout
        self.stderr: IO[bytes] | None = self._process.stderr

    def _start(
        self, command: Sequence[str], pass_fds: tuple[int, ...], writable: list[str] | None, settings: dict[str, Any]
    ) -> None:
        ours, owner = os.pipe()
        self._report, report = os.pipe()
        os.set_blocking(self._report, False)
        self._owner = owner
        orders = json.dumps({"limits": asdict(self.limits), "writable": writable, "owner": ours, "report": report})
        keeper = [sys.executable, "-I", "-S", str(_KEEPER), orders, *command]
        try:
            self._process = subprocess.Popen(
                keeper, pass_fds=(ours, report, *pass_fds), start_new_session=True, **settings
            )
        except BaseException:
            os.close(self._owner)
            os.close(self._report)
            raise
        finally:
            os.close(ours)
            os.close(report)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()
        for stream in (self.stdin, self.stdout, self.stderr):
            if stream is not None:
                with suppress(OSError):
                    stream.close()

    @property
    def pid(self) -> int | None:
        """The process number of the command, None as long as it has not started."""
        if sys.platform == "win32":
            return self._process.pid
        self.poll()
        return self._pid

    def family(self) -> list[processes.Process]:
        """The command and all its descendants that still run; none where the system does not tell."""
        return processes.below(self._process.pid, processes.everything())

    def poll(self) -> Ending | None:
        """How it ended, None as long as it runs."""
        return self.wait(0.0)

    def wait(self, seconds: float) -> Ending | None:
        """Wait for its end, for that long at most; None if it still runs."""
        if self._ending is None and sys.platform == "win32":
            with suppress(subprocess.TimeoutExpired):
                self._ending = Ending(self._process.wait(seconds))
        elif self._ending is None:
            self._listen(seconds)
        return self._ending

    def end(self) -> Ending:
        """End the command and all its descendants, if they still run; how it ended."""
        if self._ending is None:
            if sys.platform == "win32":
                subprocess.run(["taskkill", "/F", "/T", "/PID", str(self._process.pid)], check=False)
                self._ending = Ending(self._process.wait(), "owner")
            else:
                self._release()
        return self._ending or Ending(None, "keeper")

    def _release(self) -> None:
        """Tell the keeper to end it all; without a keeper, end what bears the mark."""
        if self._owner >= 0:
            os.close(self._owner)
            self._owner = -1
        for _ in range(_TRIES):
            with suppress(ProcessLookupError):
                os.kill(self._process.pid, signal.SIGCONT)  # it may have been stopped by what it watches
            if self.wait(_PATIENCE) is not None:
                return
        self._process.kill()
        self._finish(Ending(None, "keeper"))

    def _listen(self, seconds: float) -> None:
        until = monotonic() + seconds
        while self._ending is None:
            ready, _, _ = select.select([self._report], [], [], max(0.0, until - monotonic()))
            if not ready:
                return
            data = os.read(self._report, 4096)
            self._text += data
            *lines, self._text = self._text.split(b"\n")
            for line in lines:
                self._note(line)
            if not data and self._ending is None:
                self._finish(Ending(None, "keeper"))

    def _note(self, line: bytes) -> None:
        event = json.loads(line)
        if "pid" in event:
            self._pid = event["pid"]
        else:
            self._finish(Ending(event["code"], event["reason"], event["left"], event["peak"]))

    def _finish(self, ending: Ending) -> None:
        self._process.wait()
        found = 0
        if ending.reason == "keeper":
            found = processes.end_all(lambda: processes.bearing(self._mark))
        os.close(self._report)
        if self._owner >= 0:
            os.close(self._owner)
            self._owner = -1
        self._ending = Ending(ending.code, ending.reason, ending.left + found, ending.peak)
