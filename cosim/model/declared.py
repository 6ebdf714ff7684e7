"""The faces of models that need not be built to be known: what their declaration says that a user can set."""

from __future__ import annotations

from cosim.model.face import Face, Port
from fmukit.interface import Interface, Variable


def declared_face(interface: Interface) -> Face:
    """What can be set of a model, by name, type, unit and range; nothing that a run needs."""
    return Face(interface.name, {each.name: _port(each) for each in interface.variables}, interface.step)


def _port(variable: Variable) -> Port:
    return Port(
        name=variable.name,
        reference=0,
        causality=variable.causality,
        type=variable.type,
        unit=variable.unit,
        minimum=variable.minimum,
        maximum=variable.maximum,
        start=variable.start,
    )
