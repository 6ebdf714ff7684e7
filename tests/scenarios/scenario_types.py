"""The types of the fixtures in conftest.py, for tests to name."""

from __future__ import annotations

from collections.abc import Callable

from cosim.model.configuration import Configuration
from cosim.run.running import Finished

Run = Callable[..., Finished]
Configured = Callable[..., Configuration]
