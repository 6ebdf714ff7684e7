"""In which order instances run, and when.

Scheme "multirate": sampled instances run in dataflow order, each reading the newest signals. Edges out of continuous
instances are delays: the value read is that of the communication point. Cycles among sampled instances are broken at
their slowest edge. Scheme "jacobi", that of most other tools: all due instances take their inputs at the tick and step
together, and what they put out appears when their step ends; every edge is a delay.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from heapq import heappop, heappush
from typing import Literal

from cosim.model.clock import base_tick, hyperperiod
from cosim.model.node import Node

Edge = tuple[str, str]
Scheme = Literal["multirate", "jacobi"]


@dataclass(frozen=True, slots=True)
class Schedule:
    """`sequential` in the order they run at a tick; `parallel` step together after them. Times in ns."""

    sequential: tuple[str, ...]
    parallel: tuple[str, ...]
    broken: tuple[Edge, ...]
    tick: int
    cycle: int

    @property
    def initial(self) -> tuple[str, ...]:
        """The order of initialisation: plants first, then along the dataflow."""
        return self.parallel + self.sequential


def schedule(nodes: Mapping[str, Node], scheme: Scheme = "multirate") -> Schedule:
    """The schedule of the nodes, which stay in their given order where the dataflow leaves a choice."""
    sampled = {name: None for name, node in nodes.items() if node.kind == "sampled"}
    continuous = tuple(name for name in nodes if name not in sampled)
    edges = {
        (connection.source, name)
        for name in sampled
        for connection in nodes[name].incoming.values()
        if connection.source in sampled and connection.source != name
    }
    periods = {name: node.period for name, node in nodes.items()}
    order, broken = _order(list(sampled), edges, periods)
    times = base_tick(periods.values()), hyperperiod(periods.values())
    if scheme == "jacobi":
        return Schedule((), (*continuous, *order), (), *times)
    return Schedule(tuple(order), continuous, tuple(broken), *times)


def active_ticks(periods: Mapping[str, int], end: int) -> Iterator[tuple[int, tuple[str, ...]]]:
    """(time, names due) for every tick in [0, end) [ns] at which anything is due, in order."""
    for time in sorted({time for period in periods.values() for time in range(0, end, period)}):
        yield time, tuple(name for name, period in periods.items() if time % period == 0)


def _order(names: list[str], edges: set[Edge], periods: Mapping[str, int]) -> tuple[list[str], list[Edge]]:
    """The dataflow order, of those that are ready the one listed first; and the edges of cycles that were broken."""
    place = {name: i for i, name in enumerate(names)}
    sources: dict[str, set[str]] = {name: set() for name in names}
    targets: dict[str, set[str]] = {name: set() for name in names}
    for source, target in edges:
        sources[target].add(source)
        targets[source].add(target)
    ready = [place[name] for name in names if not sources[name]]  # in order, so it is a heap
    waiting, broken = dict.fromkeys(names), []
    order: list[str] = []
    while waiting:
        if not ready:
            source, target = _slowest_edge(_cycle(next(iter(waiting)), sources, place), periods)
            broken.append((source, target))
            targets[source].remove(target)
            freed = _without(source, {target}, sources)
        else:
            name = names[heappop(ready)]
            order.append(name)
            del waiting[name]
            freed = _without(name, targets[name], sources)
        for name in freed:
            heappush(ready, place[name])
    return order, broken


def _without(source: str, targets: set[str], sources: Mapping[str, set[str]]) -> list[str]:
    """Which `targets` have no source any more once `source` is taken away."""
    for target in targets:
        sources[target].remove(source)
    return [target for target in targets if not sources[target]]


def _cycle(first: str, sources: Mapping[str, set[str]], place: Mapping[str, int]) -> list[Edge]:
    """One cycle, where all that wait have a source: walk back from `first` until an instance repeats."""
    path = [first]
    while True:
        source = min(sources[path[-1]], key=place.__getitem__)
        if source in path:
            loop = path[path.index(source) :]
            return list(zip([*loop[1:], source], loop, strict=True))
        path.append(source)


def _slowest_edge(cycle: list[Edge], periods: Mapping[str, int]) -> Edge:
    """The edge whose values are oldest anyway: out of the instance with the longest period."""
    return max(cycle, key=lambda edge: (periods[edge[0]], periods[edge[1]], edge))
