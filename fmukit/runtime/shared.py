"""What the instances of a process share: made for the first of its users, let go with the last."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any


class Shared:
    """Things by key with the number of their users. Instances may come and go in several threads."""

    def __init__(self, lock: threading.RLock, let_go: Callable[[Any], None]) -> None:
        self._lock, self._let_go = lock, let_go
        self._entries: dict[str, list[Any]] = {}

    def take(self, key: str, make: Callable[[], Any]) -> Any:
        """The thing at `key`, made if there is none; one more user of it."""
        with self._lock:
            entry = self._entries.get(key)
            if entry is None:
                entry = self._entries[key] = [make(), 0]
            entry[1] += 1
            return entry[0]

    def give_back(self, key: str) -> None:
        """One user less."""
        with self._lock:
            entry = self._entries[key]
            entry[1] -= 1
            if not entry[1]:
                del self._entries[key]
                self._let_go(entry[0])
