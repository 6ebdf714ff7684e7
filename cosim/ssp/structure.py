"""What the files of a system say, as data: a tree of systems and components, their connectors, connections and values.

Numbers of chapters are those of the standard SSP 2.0, which words the rules of 1.0 more fully.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from cosim.model.face import Kind
from cosim.model.units import Conversion, Unit
from cosim.ssp.document import Where

AS_IT_IS = Conversion()
Items = tuple[tuple[str, int], ...]
"""Names and values of an enumeration."""


@dataclass(frozen=True, slots=True)
class Connector:
    """A connector of an element, or an entry of a signal dictionary; `type`, `unit` and `items` where they are said."""

    name: str
    kind: str
    type: str | None
    unit: Unit | None
    items: Items
    where: Where


@dataclass(frozen=True, slots=True)
class Change:
    """A transformation (4.5.2): `linear`, or a map of values, in texts, of Booleans, Integers or Enumerations."""

    kind: Literal["linear", "Boolean", "Integer", "Enumeration"]
    linear: Conversion = AS_IT_IS
    entries: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class End:
    """One end of a connection: a connector of an element, or of the system itself where `element` is None."""

    element: str | None
    connector: str

    def __str__(self) -> str:
        return self.connector if self.element is None else f"{self.element}.{self.connector}"


@dataclass(frozen=True, slots=True)
class Joint:
    """A connection (5.3.2); which of its ends gives the value follows from their kinds."""

    start: End
    end: End
    suppressed: bool
    change: Change | None
    where: Where


@dataclass(frozen=True, slots=True)
class Parameter:
    """One value of a parameter set (6.2), as text; `unit` of a Real where it is said."""

    name: str
    type: str
    text: str
    unit: Unit | None
    where: Where


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry of a parameter mapping (7.1.1)."""

    source: str
    target: str
    suppressed: bool
    change: Change | None
    where: Where


@dataclass(frozen=True, slots=True)
class Binding:
    """A parameter set applied to an element (5.2.3); `entries` None: by the parameters' own names."""

    parameters: tuple[Parameter, ...]
    entries: tuple[Entry, ...] | None
    prefix: str


@dataclass(frozen=True, slots=True)
class Component:
    """An FMU: `model` is what it is called, `file` where it is."""

    name: str
    model: str
    file: Path
    connectors: dict[str, Connector]
    bindings: tuple[Binding, ...]
    where: Where


@dataclass(frozen=True, slots=True)
class Reference:
    """A reference to a signal dictionary (5.5), which gives access to its signals."""

    name: str
    dictionary: str
    connectors: dict[str, Connector]
    where: Where


@dataclass(frozen=True, slots=True)
class Tree:
    """A system with what it contains."""

    name: str
    connectors: dict[str, Connector]
    elements: dict[str, Component | Tree | Reference]
    joints: tuple[Joint, ...]
    bindings: tuple[Binding, ...]
    dictionaries: dict[str, dict[str, Connector]]
    where: Where


@dataclass(frozen=True, slots=True)
class Told:
    """What our annotation says of one instance; `name` is what it is called here."""

    element: str
    name: str
    period: float | None
    kind: Kind | None
    where: Where


@dataclass(frozen=True, slots=True)
class ToldEvent:
    """An input that changes during the run, as our annotation says."""

    time: float
    element: str
    connector: str
    value: str
    where: Where


@dataclass(frozen=True, slots=True)
class Annotated:
    """What our annotation says of the whole system: all that SSP leaves open."""

    record_every: float = 0.0
    unrecorded: tuple[str, ...] = ()
    instances: tuple[Told, ...] = ()
    events: tuple[ToldEvent, ...] = ()
