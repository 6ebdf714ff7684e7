"""What FMUs log: each slave has a mailbox of its own that keeps the last sentence about something wrong.

An FMU hands its messages to one C function, with the environment its instance was given. That is the number of the
slave's mailbox, so two runs in one process never see each other's messages.
"""

from __future__ import annotations

from ctypes import byref
from itertools import count
from typing import Any
from weakref import WeakValueDictionary

from fmpy import calloc, free
from fmpy.fmi2 import (
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
)

from cosim.engine.slave import WARNING

try:
    from fmpy.logging import addLoggerProxy
except OSError:  # a native library that not every platform has
    addLoggerProxy = None


class Mailbox:
    """The last message of one instance that was a warning or worse."""

    def __init__(self) -> None:
        self.number = next(_numbers)
        self.text = ""
        _mailboxes[self.number] = self


_numbers = count(1)
_mailboxes: WeakValueDictionary[int, Mailbox] = WeakValueDictionary()


def _note(environment: int | None, _instance: bytes, status: int, _category: bytes, message: bytes) -> None:
    mailbox = _mailboxes.get(environment or 0)
    if mailbox is not None and status >= WARNING and message:
        mailbox.text = " ".join(message.decode("utf-8", "replace").split())


_logger = fmi2CallbackLoggerTYPE(_note)
_allocate, _free = fmi2CallbackAllocateMemoryTYPE(calloc), fmi2CallbackFreeMemoryTYPE(free)


def callbacks(mailbox: Mailbox, *, formatted: bool) -> Any:
    """The callbacks of one instance, whose messages go to `mailbox`.

    `formatted` puts FMPy's printf proxy before the logger. PythonFMU hands Python text over as the format itself,
    where a stray % would read arguments that do not exist, so its messages are taken as they are.
    """
    made = fmi2CallbackFunctions()
    made.logger, made.allocateMemory, made.freeMemory = _logger, _allocate, _free
    made.componentEnvironment = mailbox.number
    if formatted and addLoggerProxy is not None:
        addLoggerProxy(byref(made))
    return made
