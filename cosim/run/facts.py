"""What is known of a run beside its signals."""

from __future__ import annotations

from cosim.model.clock import SECOND, to_seconds
from cosim.results.reading import Facts
from cosim.run.prepare import RunPlan


def facts(made: RunPlan, stop: float | None = None) -> Facts:
    """What its metrics may ask for; `stop` [s] is when it was to end, unless its plan says."""
    configuration = made.configured.configuration
    return Facts(
        periods={name: node.period / SECOND for name, node in made.nodes.items()},
        settings=made.configured.settings,
        values={name: configuration.values(name) | node.values for name, node in made.nodes.items()},
        stop=to_seconds(made.request.stop) if stop is None else stop,
        absent=frozenset(
            signal
            for name, original in made.configured.originals.items()
            for signal in original.silent(made.nodes[name].face)
        ),
    )
