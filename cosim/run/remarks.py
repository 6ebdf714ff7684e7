"""What a user should know of the models of a run before it starts, though nothing is wrong."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cosim.model.clock import SECOND, to_seconds
from cosim.model.configuration import SAMPLE_PERIOD
from cosim.model.node import Node
from cosim.model.system import System


def remarks(system: System, nodes: Mapping[str, Node]) -> list[str]:
    """One sentence for each model whose description means something other than what the master does."""
    first: dict[tuple[str, str], str] = {}
    for name, node in nodes.items():
        for sentence in (_begins_later(node), _taken_as_sampled(node, said=system.instances[name].kind is not None)):
            first.setdefault((node.model, sentence), name)
    found = [f"{name}: {sentence}" for (_, sentence), name in first.items() if sentence]
    return found + [sentence for node in nodes.values() for sentence in _missed(node)]


def _missed(node: Node) -> Iterator[str]:
    """Faults that end before the instance takes its inputs."""
    for name, faults in node.faults.items():
        for fault in faults:
            first = -(-round(fault.begin * SECOND) // node.period) * node.period
            if to_seconds(first) >= fault.end:
                yield (
                    f"{node.name}.{name}: nothing is taken in between {fault.begin:g} and {fault.end:g} s, so the "
                    f"event has no effect; {node.name} takes its inputs every {to_seconds(node.period):g} s"
                )


def _begins_later(node: Node) -> str:
    if not node.face.begin:
        return ""
    return f"its default experiment starts at {node.face.begin:g} s; runs start at 0 s"


def _taken_as_sampled(node: Node, *, said: bool) -> str:
    """A plant whose tool declares every output discrete would be shown one step early."""
    if said or node.kind != "sampled" or SAMPLE_PERIOD in node.face.ports or not node.face.outputs:
        return ""
    return (
        "all its outputs are discrete, so it runs as a controller, whose outputs belong to the start of a step; "
        'if it is a plant, say so: System.add(..., kind="continuous")'
    )
