"""What the instances of a process share: made for the first of its users, let go with the last."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass(slots=True)
class _Entry:
    thing: Any
    users: int


class Shared:
    """Things by key with the number of their users. Instances may come and go in several threads."""

    def __init__(self, lock: threading.RLock, let_go: Callable[[Any], None]) -> None:
        self._lock, self._let_go = lock, let_go
        self._entries: dict[str, _Entry] = {}

    def take(self, key: str, make: Callable[[], Any]) -> Any:
        """The thing at `key`, made if there is none; one more user of it."""
        with self._lock:
            entry = self._entries.get(key)
            if entry is None:
                entry = self._entries[key] = _Entry(make(), 0)
            entry.users += 1
            return entry.thing

    def give_back(self, key: str) -> None:
        """One user less."""
        with self._lock:
            entry = self._entries[key]
            entry.users -= 1
            if not entry.users:
                del self._entries[key]
                self._let_go(entry.thing)
