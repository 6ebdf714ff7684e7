"""Parameters that other instances calculate: they are set while all initialise, and stay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cosim.engine.order import Action
from cosim.engine.slave import ERROR, Slave, SlaveError, do_nothing
from cosim.model.face import Value
from cosim.model.node import Connection, Node
from cosim.model.signals import Vector


def giving(
    node: Node, slave: Slave, numbers: tuple[Vector, Mapping[str, int]], texts: tuple[Sequence[str], Mapping[str, int]]
) -> Action:
    """Sets the parameters of the node from signals and their places in `numbers`, or in `texts`."""

    def value(connection: Connection) -> Value:
        signal, type_ = f"{connection.source}.{connection.output}", node.face.ports[connection.input].type
        if type_ == "String":
            return texts[0][texts[1][signal]]
        try:
            number = connection.transformation(float(numbers[0][numbers[1][signal]]))
        except LookupError:
            raise SlaveError(node.name, ERROR, f"{connection.text} has no entry for its value") from None
        return number if type_ == "Real" else round(number) != 0 if type_ == "Boolean" else round(number)

    def give() -> None:
        slave.set({connection.input: value(connection) for connection in node.given.values()})

    return give if node.given else do_nothing
