"""What `--explain` prints: who runs when and in which order, what feeds what, which edges are delays."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from rich.table import Table

from cosim.engine.schedule import Schedule
from cosim.model.clock import to_seconds
from cosim.model.node import Connection, Node
from cosim.run.prepare import RunPlan


def explanation(plan: RunPlan) -> list[tuple[str, Table]]:
    """Titles and tables: order of execution and edges; if any, unit conversions, events and unconnected inputs."""
    name, tick = plan.request.scenario.name, _ms(to_seconds(plan.schedule.tick))
    tables = {
        f"{name}: order at each tick (base tick {tick})": _order(plan),
        "edges": _edges(plan.nodes, plan.schedule),
        "unit conversions": _conversions(plan.nodes),
        "values set during the run": _changes(plan),
        "inputs that hold their start value": _unconnected(plan.nodes),
    }
    return [(title, table) for title, table in tables.items() if table.row_count]


def _order(plan: RunPlan) -> Table:
    table = _table("step", "instance", "model", "kind", "period")
    for step, name in enumerate(plan.schedule.sequential + plan.schedule.parallel, start=1):
        node = plan.nodes[name]
        place = str(step) if name in plan.schedule.sequential else "then, together"
        table.add_row(place, name, node.face.model, node.kind, _ms(to_seconds(node.period)))
    return table


def _edges(nodes: Mapping[str, Node], schedule: Schedule) -> Table:
    table = _table("from", "to", "signals", "value read")
    counts = Counter((c.source, c.target) for node in nodes.values() for c in node.incoming.values())
    for (source, target), count in counts.items():
        table.add_row(source, target, str(count), _reading(source, target, schedule))
    once = Counter((c.source, c.target) for node in nodes.values() for c in node.given.values())
    for (source, target), count in once.items():
        table.add_row(source, target, str(count), "once, while all initialise")
    return table


def _reading(source: str, target: str, schedule: Schedule) -> str:
    if (source, target) in schedule.broken:
        return "delay: a cycle is broken here, the value of the previous period is read"
    if source in schedule.parallel:
        return "delay: the value at the communication point, held over the step"
    return "newest"


def _conversions(nodes: Mapping[str, Node]) -> Table:
    table = _table("connection", "from", "to", "factor", "offset")
    for c in _connections(nodes):
        if c.transformation.steps:
            units = (nodes[c.source].face.ports[c.output].unit, nodes[c.target].face.ports[c.input].unit)
            linear = c.transformation.linear
            numbers = (f"{linear.factor:g}", f"{linear.offset:g}") if linear else ("by a list", "")
            table.add_row(c.text, *(unit or "" for unit in units), *numbers)
    return table


def _changes(plan: RunPlan) -> Table:
    table = _table("at", "input", "value", "taken in")
    found = [(change, node) for node in plan.nodes.values() for change in node.changes]
    for change, node in sorted(found, key=lambda pair: pair[0].time):
        unit = node.face.ports[change.variable].unit or ""
        value = f"{change.value} {unit if unit != '1' else ''}".strip()
        taken = f"{to_seconds(change.due):g} s" if change.due < plan.request.stop else "never: after the end"
        table.add_row(f"{to_seconds(change.time):g} s", f"{node.name}.{change.variable}", value, taken)
    return table


def _unconnected(nodes: Mapping[str, Node]) -> Table:
    table = _table("instance", "inputs")
    for node in nodes.values():
        changed = {change.variable for change in node.changes}
        free = [name for name in node.face.inputs if name not in node.incoming and name not in changed]
        if free:
            table.add_row(node.name, ", ".join(free))
    return table


def _connections(nodes: Mapping[str, Node]) -> list[Connection]:
    return [connection for node in nodes.values() for connection in node.connections]


def _table(*columns: str) -> Table:
    return Table(*columns, header_style="bold")


def _ms(seconds: float) -> str:
    return f"{seconds * 1e3:g} ms"
